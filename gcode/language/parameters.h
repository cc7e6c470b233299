#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/language/expression.h"

namespace gcode {

/// #1 to #33, index 0 unused. LinuxCNC has the first 30, initially 0.
using LocalParameters = std::array<Value, 34>;

using NamedValues = std::map<std::string, double, std::less<>>;

/// The highest number a numbered parameter may have.
constexpr int highest_parameter = 20000;

/// The most named parameters a program may make on one level.
constexpr size_t most_named_parameters = 100000;

/// Parameters that all levels of calls see.
class Parameters {
public:
    /// Empty when it was never set.
    Value numbered(int number) const {
        const auto at = static_cast<size_t>(number);
        return at < numbered_.size() ? numbered_[at] : Value{};
    }
    void set_numbered(int number, Value value);

    /// How many numbered ones there is room for.
    size_t numbered_count() const { return numbered_.size(); }

    /// `#<_name>`
    const NamedValues& named() const { return named_; }
    void set_named(std::string_view name, Value value); // an empty value takes it away

    /// Follows from the values, in no time.
    uint64_t digest() const { return digest_; }

    /// One that was never set equals one that was set and taken away again.
    bool operator==(const Parameters& other) const;

private:
    std::vector<Value> numbered_; // grows as needed
    NamedValues named_;
    uint64_t digest_ = 0;
};

} // namespace gcode
