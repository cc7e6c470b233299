#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gcode {

/// Mixes the bits of a number so that each affects all others (the finaliser of SplitMix64).
constexpr uint64_t spread(uint64_t bits) {
    bits ^= bits >> 30;
    bits *= 0xBF58476D1CE4E5B9ULL;
    bits ^= bits >> 27;
    bits *= 0x94D049BB133111EBULL;
    return bits ^ (bits >> 31);
}

/// Hash of a sequence of values. Different sequences have different hashes, except by coincidence.
class Digest {
public:
    void add(uint64_t bits) { value_ = spread(value_ + 0x9E3779B97F4A7C15ULL + bits); }
    void add(double number) { add(std::bit_cast<uint64_t>(number == 0.0 ? 0.0 : number)); }
    void add(const std::optional<double>& number) {
        add(uint64_t{number.has_value()});
        if (number) add(*number);
    }
    void add(std::string_view text) {
        add(uint64_t{text.size()});
        for (const char c : text) add(static_cast<uint64_t>(static_cast<unsigned char>(c)));
    }

    uint64_t value() const { return value_; }

private:
    uint64_t value_ = 0;
};

} // namespace gcode
