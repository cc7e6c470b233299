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

void Parameters::put(int number, Value value) {
    const auto at = static_cast<size_t>(number);
    if (numbered_.size() <= at) numbered_.resize(at + 1);
    digest_ ^= digest_of_value(at, numbered_[at]) ^ digest_of_value(at, value);
    numbered_[at] = value;
}

void Parameters::put(std::string_view name, Value value) {
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

bool Parameters::put_mark(int number, bool unpredictable) {
    const bool changed =
        unpredictable ? unpredictable_.insert(number).second : unpredictable_.erase(number) > 0;
    if (changed) digest_ ^= key_of(fmt::format("?{}", number));
    return changed;
}

bool Parameters::put_mark(std::string_view name, bool unpredictable) {
    const bool changed = unpredictable ? unpredictable_names_.emplace(name).second
                                       : unpredictable_names_.erase(std::string(name)) > 0;
    if (changed) digest_ ^= key_of(fmt::format("?{}", name));
    return changed;
}

void Parameters::set_numbered(int number, Value value) {
    changes_.push_back({false, false, number, {}, numbered(number)});
    put(number, value);
}

void Parameters::set_named(std::string_view name, Value value) {
    const auto found = named_.find(name);
    changes_.push_back({false, true, 0, std::string(name),
                        found == named_.end() ? Value{} : Value{found->second}});
    put(name, value);
}

void Parameters::mark(int number, bool unpredictable) {
    if (put_mark(number, unpredictable))
        changes_.push_back({true, false, number, {}, unpredictable ? 0.0 : 1.0});
}

void Parameters::mark(std::string_view name, bool unpredictable) {
    if (put_mark(name, unpredictable))
        changes_.push_back({true, true, 0, std::string(name), unpredictable ? 0.0 : 1.0});
}

void Parameters::take_back_changes() {
    for (auto change = changes_.rbegin(); change != changes_.rend(); ++change) {
        if (change->is_mark && change->is_named)
            put_mark(change->name, *change->before == 1.0);
        else if (change->is_mark)
            put_mark(change->number, *change->before == 1.0);
        else if (change->is_named)
            put(change->name, change->before);
        else
            put(change->number, change->before);
    }
    changes_.clear();
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
