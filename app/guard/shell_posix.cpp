#include <array>
#include <cstdio>

#include <sys/wait.h>

#include "app/guard/shell.h"

namespace app {
namespace {

/// A word that the shell takes as it is.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

} // namespace

core::Result<ShellOutput> run_in_shell(const std::string& command, const std::string& file) {
    FILE* const pipe = ::popen((command + " " + quoted(file)).c_str(), "r");
    if (!pipe) return core::fail(core::ErrorCode::unsupported, "cannot be started");
    ShellOutput output;
    std::array<char, 65536> block{};
    for (size_t count = 1; count > 0;) {
        count = std::fread(block.data(), 1, block.size(), pipe);
        output.bytes.append(block.data(), count);
    }
    const bool is_whole = std::feof(pipe) != 0;
    const int status = ::pclose(pipe);
    if (!is_whole) return core::fail(core::ErrorCode::io, "cannot be read to its end");
    output.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return output;
}

} // namespace app
