#include <random>

#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "core/formats/zip_archive.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/zip_writer.h"

namespace app {
namespace {

using test_support::packed_zip_of;
using test_support::zip_of;

const test_support::ScopedFolder& zip_folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

core::Result<core::ZipArchive> opened(const std::string& bytes) {
    return core::ZipArchive::open(zip_folder().write("a.zip", bytes));
}

std::string refusal_of(const std::string& bytes, const std::string& name, size_t limit = 1 << 20) {
    const auto archive = opened(bytes);
    if (!archive) return error_text(archive.error());
    const auto text = archive->read(name, limit);
    return text ? "" : error_text(text.error());
}

TEST(ZipArchive, ReadsStoredAndPackedFiles) {
    const std::string long_text(100000, 'x');
    for (const std::string& bytes :
         {zip_of({{"a.txt", "hello"}, {"b/c", long_text}, {"e", ""}}),
          packed_zip_of({{"a.txt", "hello"}, {"b/c", long_text}, {"e", ""}})}) {
        const auto archive = opened(bytes);
        ASSERT_TRUE(archive.has_value()) << error_text(archive.error());
        EXPECT_EQ(archive->names(), (std::vector<std::string>{"a.txt", "b/c", "e"}));
        EXPECT_EQ(archive->read("a.txt", 100).value_or("?"), "hello");
        EXPECT_EQ(archive->read("b/c", long_text.size()).value_or("?"), long_text);
        EXPECT_EQ(archive->read("e", 0).value_or("?"), "");
        EXPECT_TRUE(archive->contains("e"));
        EXPECT_FALSE(archive->contains("E"));
    }
}

TEST(ZipArchive, RefusesWhatItMustNotUnpack) {
    const std::string bomb = packed_zip_of({{"a", std::string(8 << 20, '\0')}});
    EXPECT_LT(bomb.size(), 10000u);
    EXPECT_NE(refusal_of(bomb, "a").find("a in the archive is larger than 1 MiB"),
              std::string::npos);
    EXPECT_NE(refusal_of(zip_of({{"a", "x"}}, 1), "a").find("is encrypted"), std::string::npos);
    EXPECT_NE(refusal_of(zip_of({{"a", "x"}}), "b").find("b in the archive is missing"),
              std::string::npos);
    EXPECT_NE(refusal_of("PK", "a").find("is no zip archive"), std::string::npos);
    EXPECT_NE(refusal_of("", "a").find("is no zip archive"), std::string::npos);
    std::string changed = zip_of({{"a", "hello"}});
    changed[changed.find("hello")] = 'j';
    EXPECT_NE(refusal_of(changed, "a").find("is damaged"), std::string::npos);
    const auto missing = core::ZipArchive::open("none.zip");
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(missing.error().file, "none.zip");
}

TEST(ZipArchive, NamesLeadNowhere) {
    const auto archive = opened(zip_of({{"../../etc/passwd", "x"}, {"/abs", "y"}}));
    ASSERT_TRUE(archive.has_value());
    EXPECT_EQ(archive->read("/abs", 10).value_or("?"), "y");
}

TEST(ZipArchive, DamagedArchivesAreReadOrRefused) {
    const std::string good = packed_zip_of({{"a", std::string(3000, 'q') + "end"}, {"b", "other"}});
    std::mt19937 random(11);
    size_t refused = 0;
    for (int round = 0; round < 600; ++round) {
        std::string bytes = good;
        for (unsigned change = 0; change < 1 + random() % 3; ++change)
            bytes[random() % bytes.size()] = static_cast<char>(random());
        if (round % 4 == 0) bytes.resize(random() % bytes.size());
        const auto archive = opened(bytes);
        if (!archive) {
            ++refused;
            continue;
        }
        for (const std::string& name : archive->names()) {
            const auto text = archive->read(name, 1 << 16);
            EXPECT_LE(text ? text->size() : 0, size_t(1) << 16);
        }
    }
    EXPECT_GT(refused, 100u);
}

} // namespace
} // namespace app
