#include "app/commands/output.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "app/report/text_report.h"

namespace app {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

tl::unexpected<core::Error> refused(const std::string& path, const std::string& why) {
    return tl::unexpected<core::Error>({core::ErrorCode::io, {}, why, path});
}

bool write_all(std::FILE* file, const std::string& text) {
    return std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
}

} // namespace

core::Result<void> write_output(const std::string& path, const std::string& text) {
    if (path.empty()) {
        if (!write_all(stdout, text)) return refused("standard output", "cannot be written");
        return {};
    }
    std::error_code failure;
    const std::filesystem::path target = std::filesystem::weakly_canonical(path, failure);
    if (failure) return refused(path, "cannot be written: " + failure.message());
    const auto kind = std::filesystem::status(target, failure).type();
    if (kind == std::filesystem::file_type::directory) return refused(path, "is a folder");
    const bool replace = kind == std::filesystem::file_type::regular
                         || kind == std::filesystem::file_type::not_found;
    const std::string fresh =
        replace ? fmt::format("{}.{}.new", target.string(), ::getpid()) : target.string();
    std::unique_ptr<std::FILE, Close> file(std::fopen(fresh.c_str(), "wb"));
    if (!file) return refused(path, "cannot be written: no such folder, or no permission");
    const bool written =
        write_all(file.get(), text) && (!replace || ::fsync(::fileno(file.get())) == 0);
    file.reset();
    failure.clear();
    if (written && replace) std::filesystem::rename(fresh, target, failure);
    if (written && !failure) return {};
    if (!replace) return refused(path, "could not be written to its end");
    std::filesystem::remove(fresh, failure);
    return refused(path, "could not be written to its end; what was there is unchanged");
}

void print_error(const core::Error& error) {
    fmt::print(stderr, "feeler: {}\n", error_text(error));
}

} // namespace app
