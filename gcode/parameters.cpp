#include "gcode/parameters.h"

#include "gcode/digest.h"

namespace gcode {
namespace {

uint64_t share_of(uint64_t key, const Value& value) {
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
    digest_ ^= share_of(at, numbered_[at]) ^ share_of(at, value);
    numbered_[at] = value;
}

void Parameters::set_named(std::string_view name, Value value) {
    const auto found = named_.find(name);
    const uint64_t key = key_of(name);
    digest_ ^= share_of(key, found != named_.end() ? Value{found->second} : Value{});
    digest_ ^= share_of(key, value);
    if (!value && found != named_.end())
        named_.erase(found);
    else if (value && found != named_.end())
        found->second = *value;
    else if (value)
        named_.emplace(name, *value);
}

} // namespace gcode
