#include <cstdio>
#include <fstream>

#include "app/report/html_batch.h"
#include "tests/support/large_batch.h"

/// Writes the page of 10,000 programs to the file that is named.
int main(int count, char** words) {
    if (count != 2) return 2;
    app::BatchResult batch = test_support::large_batch(10'000, 8);
    batch.unchecked = {"parts/order 1/never.nc"};
    std::ofstream file(words[1], std::ios::binary);
    file << app::batch_html_report(batch);
    return file ? 0 : 1;
}
