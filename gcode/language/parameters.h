#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/language/expression.h"

namespace gcode {

/// #1 to #33; index 0 is not used. LinuxCNC has 30, which start at 0.
using LocalParameters = std::array<Value, 34>;

using NamedValues = std::map<std::string, double, std::less<>>;

/// The highest number of a numbered parameter.
constexpr int highest_parameter = 20000;

/// The maximum number of named parameters on one call level.
constexpr size_t most_named_parameters = 100000;

/// The parameters that all call levels share. They keep the changes since the last
/// `begin_changes()`, so that a block that fails can be taken back without a copy of them all.
class Parameters {
public:
    /// The value of a numbered parameter; empty if it was never set.
    Value numbered(int number) const {
        const auto at = static_cast<size_t>(number);
        return at < numbered_.size() ? numbered_[at] : Value{};
    }
    void set_numbered(int number, Value value);

    /// Number of the numbered parameters for which memory is allocated.
    size_t numbered_count() const { return numbered_.size(); }

    /// Global named parameters: `#<_name>`.
    const NamedValues& named() const { return named_; }
    void set_named(std::string_view name, Value value); // an empty value removes it

    /// Variables whose value depends on one that only the machine knows.
    bool is_unpredictable(int number) const {
        return !unpredictable_.empty() && unpredictable_.contains(number);
    }
    const std::set<std::string, std::less<>>& unpredictable_names() const {
        return unpredictable_names_;
    }
    void mark(int number, bool unpredictable);
    void mark(std::string_view name, bool unpredictable);

    /// Hash of all values and marks; kept up to date, so it costs nothing.
    uint64_t digest() const { return digest_; }

    bool has_changes() const { return !changes_.empty(); }
    void begin_changes() { changes_.clear(); }
    void take_back_changes();

    /// A parameter that was never set equals one that was set and removed again.
    bool operator==(const Parameters& other) const;

private:
    /// The value or mark of a parameter before a change.
    struct Change {
        bool is_mark, is_named;
        int number;
        std::string name;
        Value before; // of a mark: 1 or 0
    };
    void put(int number, Value value);
    void put(std::string_view name, Value value);
    bool put_mark(int number, bool unpredictable);
    bool put_mark(std::string_view name, bool unpredictable);

    std::vector<Value> numbered_; // grows as needed
    NamedValues named_;
    std::set<int> unpredictable_;
    std::set<std::string, std::less<>> unpredictable_names_;
    uint64_t digest_ = 0;
    std::vector<Change> changes_; // in order; no part of what the parameters are
};

} // namespace gcode
