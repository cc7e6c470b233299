#include "gcode/language/parameters.h"

#include <algorithm>

#include <fmt/format.h>

#include "gcode/text/digest.h"

namespace gcode {
namespace {

uint64_t digest_of_value(uint64_t key, const Value& value) {
    if (!value) return 0;
    Digest digest;
    digest.add(key);
    digest.add(*value);
    return digest.value();
}

uint64_t key_of(std::string_view name) {
    Digest digest;
    digest.add(name);
    return digest.value();
}

} // namespace

void Parameters::set_numbered(int number, Value value) {
    const auto at = static_cast<size_t>(number);
    if (numbered_.size() <= at) numbered_.resize(at + 1);
    digest_ ^= digest_of_value(at, numbered_[at]) ^ digest_of_value(at, value);
    numbered_[at] = value;
}

void Parameters::set_named(std::string_view name, Value value) {
    const auto found = named_.find(name);
    const uint64_t key = key_of(name);
    digest_ ^= digest_of_value(key, found != named_.end() ? Value{found->second} : Value{});
    digest_ ^= digest_of_value(key, value);
    if (!value && found != named_.end())
        named_.erase(found);
    else if (value && found != named_.end())
        found->second = *value;
    else if (value)
        named_.emplace(name, *value);
}

void Parameters::mark(int number, bool unpredictable) {
    const bool changed =
        unpredictable ? unpredictable_.insert(number).second : unpredictable_.erase(number) > 0;
    if (changed) digest_ ^= key_of(fmt::format("?{}", number));
}

void Parameters::mark(std::string_view name, bool unpredictable) {
    const bool changed = unpredictable ? unpredictable_names_.emplace(name).second
                                       : unpredictable_names_.erase(std::string(name)) > 0;
    if (changed) digest_ ^= key_of(fmt::format("?{}", name));
}

bool Parameters::operator==(const Parameters& other) const {
    if (digest_ != other.digest_ || named_ != other.named_ || unpredictable_ != other.unpredictable_
        || unpredictable_names_ != other.unpredictable_names_)
        return false;
    const size_t common = std::min(numbered_.size(), other.numbered_.size());
    const auto is_unset = [](const Value& value) { return !value; };
    return std::equal(numbered_.begin(), numbered_.begin() + static_cast<std::ptrdiff_t>(common),
                      other.numbered_.begin())
           && std::all_of(numbered_.begin() + static_cast<std::ptrdiff_t>(common), numbered_.end(),
                          is_unset)
           && std::all_of(other.numbered_.begin() + static_cast<std::ptrdiff_t>(common),
                          other.numbered_.end(), is_unset);
}

} // namespace gcode
