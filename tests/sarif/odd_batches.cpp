#include <fstream>
#include <string>

#include "app/report/exchange/exchange_reports.h"
#include "tests/support/large_batch.h"

namespace {

std::string every_byte() {
    std::string text;
    for (int byte = 0; byte < 256; ++byte) text += static_cast<char>(byte);
    return text;
}

/// A batch that was ended early, with names and texts of any bytes.
app::BatchResult odd_batch() {
    app::BatchResult batch = test_support::large_batch(60, 5);
    for (app::StoredFinding& finding : batch.programs[3].findings)
        finding.text = finding.message = finding.cure = every_byte();
    batch.programs[3].findings[0].file = "/abs/" + every_byte();
    batch.programs[4].program = every_byte();
    batch.programs[0].error->message = every_byte();
    batch.unchecked = {"late one.nc", every_byte()};
    batch.skipped = {{every_byte(), "is a document"}};
    return batch;
}

} // namespace

/// Writes SARIF of batches that no file system or shell makes easily into the folder that is named.
int main(int count, char** words) {
    if (count != 2) return 2;
    const std::string folder = words[1];
    std::ofstream odd(folder + "/odd.sarif"), empty(folder + "/empty.sarif"),
        cut(folder + "/cut.sarif");
    cut << app::sarif_report(test_support::large_batch(6000, 5), "/"); // more than hosts take
    odd << app::sarif_report(odd_batch(), "/home/me/my shop");
    empty << app::sarif_report({}, "/");
    return odd && empty && cut ? 0 : 1;
}
