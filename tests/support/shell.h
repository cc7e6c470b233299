#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "tests/support/scoped_folder.h"

namespace test_support {

/// The result of a command.
struct Ran {
    int status = -1; // of exit; 128 and more: ended by a signal
    std::string out, err;
};

/// A word quoted for the shell.
inline std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// Runs a program through the shell; `before` is shell text before it, such as `ulimit -v 9;`.
inline Ran run(const std::vector<std::string>& words, const std::string& before = "") {
    const ScopedFolder folder;
    std::string command = before;
    for (const std::string& word : words) command += " " + quoted(word);
    command += " </dev/null >" + quoted(folder / "out") + " 2>" + quoted(folder / "err");
    const int status = std::system(command.c_str());
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, bytes_of(folder / "out"), bytes_of(folder / "err")};
}

} // namespace test_support
