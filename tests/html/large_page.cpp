#include <cstdio>
#include <fstream>

#include "app/report/html/html_batch.h"
#include "tests/support/large_batch.h"

/// Writes the page of 10,000 programs and that of none to the files that are named.
int main(int count, char** words) {
    if (count != 3) return 2;
    app::BatchResult batch = test_support::large_batch(10'000, 8);
    batch.unchecked = {"parts/order 1/never.nc"};
    std::ofstream file(words[1], std::ios::binary);
    file << app::batch_html_report(batch);
    std::ofstream empty(words[2], std::ios::binary);
    empty << app::batch_html_report({});
    return file && empty ? 0 : 1;
}
