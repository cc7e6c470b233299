#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace core {

/// Writes values one after the other as they are in memory, the lowest byte first.
class ByteWriter {
public:
    explicit ByteWriter(std::string_view head = {}) : bytes(head) {}

    template <typename T>
    void put(const T& value) {
        static_assert(std::endian::native == std::endian::little);
        static_assert(std::is_trivially_copyable_v<T>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
    }

    std::string bytes;
};

/// Takes the values off again. At the end of the bytes it returns zeros and sets `ok` to false.
class ByteReader {
public:
    explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

    template <typename T>
    T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        T value{};
        const std::string_view bytes = take_bytes(sizeof(T));
        if (ok) std::memcpy(&value, bytes.data(), sizeof(T));
        return value;
    }
    /// The next bytes; none if there are not as many.
    std::string_view take_bytes(uint64_t count) {
        ok = ok && count <= rest_.size();
        if (!ok) return {};
        const std::string_view bytes = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return bytes;
    }
    /// The number of items of at least this size that follow; more than fit means damage.
    size_t take_count(size_t least_bytes) {
        const auto count = take<uint64_t>();
        ok = ok && count <= rest_.size() / least_bytes;
        return ok ? static_cast<size_t>(count) : 0;
    }
    bool is_at_end() const { return rest_.empty(); }

    bool ok = true;

private:
    std::string_view rest_;
};

} // namespace core
