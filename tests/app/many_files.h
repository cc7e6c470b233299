#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/program_writer.h"

/// A hundred thousand files of a shop; one in twenty is a program.
namespace many_files {

inline constexpr size_t all_files = 100'000, one_program_in = 20, folders = 1'000;
inline constexpr size_t programs = all_files / one_program_in;

/// A kind of file that is stored next to programs.
struct Kind {
    const char* ending;
    std::string bytes;
};

inline const Kind foreign[] = {{".txt", "notes of the shop\nabout a part\n"},
                               {".stl", "solid part\n"},
                               {".md", "# What is here\n"},
                               {"", "a few words\n"},
                               {".png", "\x89PNG"},
                               {".dat", std::string("\0\1\2", 3)}};

/// The folder of the file with this number: three levels, names with blanks and UTF-8.
inline std::string resolved_path(size_t i) {
    const size_t at = i % folders;
    return "Auftrag " + std::to_string(at % 50) + "/Gehäuse " + std::to_string(at / 50) + "/日本 "
           + std::to_string(at);
}

inline void write(const std::filesystem::path& path, const std::string& bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr) << path;
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
}

/// Writes all files.
inline void fill(const std::filesystem::path& root) {
    const std::string program =
        test_support::program({"X5. Y5.", "G1 Z-1. F200.", "X20.", "G0 Z60."});
    for (size_t i = 0; i < folders; ++i)
        std::filesystem::create_directories(root / resolved_path(i));
    for (size_t i = 0; i < all_files; ++i) {
        const bool is_program = i / folders % one_program_in == 0;
        const Kind& kind = foreign[i % std::size(foreign)];
        const std::string name = (is_program ? "part " : "ü ") + std::to_string(i);
        write(root / resolved_path(i) / (name + (is_program ? ".nc" : kind.ending)),
              is_program ? program : kind.bytes);
    }
}

} // namespace many_files
