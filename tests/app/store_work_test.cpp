#include <chrono>
#include <fstream>
#include <thread>

#include "tests/app/thousand_results.h"
#include "tests/support/io_counts.h"

namespace {

using namespace std::chrono_literals;
using store_life::ThousandResults;
using test_support::io_counts;

/// The number of writing transactions of a database, from its file header.
uint32_t transactions_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    unsigned char bytes[4] = {};
    file.seekg(24).read(reinterpret_cast<char*>(bytes), sizeof bytes);
    EXPECT_TRUE(file) << path;
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

TEST(ResultStore, WritesAThousandResultsInOneTransactionIfTheyComeAtOnce) {
    const ThousandResults results;
    const auto store = app::ResultStore::open(results.database, "1");
    ASSERT_TRUE(store);
    const uint32_t before = transactions_of(results.database);
    results.keep_all(1h); // longer than storing them takes on any machine
    EXPECT_EQ(transactions_of(results.database) - before, 1u);
}

TEST(ResultStore, ReadsAFileOnceThatAThousandResultsDependOn) {
    const ThousandResults results;
    results.keep_all();
    std::this_thread::sleep_for(100ms); // clock: at least; until no file counts as just written
    const auto before = io_counts();
    results.find_all();
    const auto after = io_counts();
    if (!before || !after) GTEST_SKIP() << "this kernel does not count what a process reads";
    EXPECT_LT(after->bytes - before->bytes, 10 * ThousandResults::mesh_bytes);
    RecordProperty("bytes", static_cast<int>(after->bytes - before->bytes));
}

} // namespace
