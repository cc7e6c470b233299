#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace core::cad {

/// How the program that reads CAD files ended.
enum class ReaderEnd : uint8_t {
    done,
    stopped,     // because `take` returned false
    not_there,   // it cannot be started
    no_library,  // the system cannot load its libraries
    out_of_time, // it used more time than it may
    crashed
};

/// Runs a program without input. Passes on what it writes, as it comes; also calls `take` with
/// nothing several times a second. Ends the program when `take` returns false.
ReaderEnd run_reader(const std::vector<std::string>& words,
                     const std::function<bool(std::string_view)>& take);

} // namespace core::cad
