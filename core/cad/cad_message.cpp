#include "core/cad/cad_message.h"

#include <cstring>
#include <type_traits>
#include <vector>

namespace core::cad {

namespace {

/// Appends values as bytes.
class Writer {
public:
    template <typename Value>
    void put(const Value& value) {
        static_assert(std::is_trivially_copyable_v<Value>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
    }
    void put_text(std::string_view text) {
        put(uint64_t{text.size()});
        bytes.append(text);
    }
    template <typename Value>
    void put_all(const std::vector<Value>& values) {
        static_assert(std::is_trivially_copyable_v<Value>);
        put(uint64_t{values.size()});
        bytes.append(reinterpret_cast<const char*>(values.data()), sizeof(Value) * values.size());
    }

    std::string bytes;
};

/// Takes the values off again. `ok` becomes false at the end of the bytes.
class Reader {
public:
    explicit Reader(std::string_view bytes) : rest_(bytes) {}

    template <typename Value>
    Value take() {
        Value value{};
        if (const auto bytes = take_bytes(sizeof(Value)))
            std::memcpy(&value, bytes->data(), sizeof(Value));
        return value;
    }
    std::string take_text() { return std::string(take_bytes(take<uint64_t>()).value_or("")); }
    template <typename Value>
    std::vector<Value> take_all() {
        const auto count = take<uint64_t>();
        std::vector<Value> values;
        ok = ok && count <= rest_.size() / sizeof(Value);
        if (!ok) return values;
        values.resize(count);
        const auto bytes = take_bytes(count * sizeof(Value));
        if (count > 0) std::memcpy(values.data(), bytes->data(), bytes->size());
        return values;
    }
    bool is_at_end() const { return rest_.empty(); }

    bool ok = true;

private:
    std::optional<std::string_view> take_bytes(uint64_t count) {
        ok = ok && count <= rest_.size();
        if (!ok) return std::nullopt;
        const std::string_view bytes = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return bytes;
    }

    std::string_view rest_;
};

} // namespace

std::string text_message(MessageKind kind, std::string_view text) {
    Writer writer;
    writer.put(kind);
    writer.put_text(text);
    return std::move(writer.bytes);
}

std::string progress_message(std::string_view step, double fraction) {
    Writer writer;
    writer.put_text(step);
    writer.put(fraction);
    return text_message(MessageKind::progress, writer.bytes);
}

std::string left_out_message(const CadSurfaces& surfaces) {
    Writer writer;
    writer.put_text(surfaces.what);
    writer.put(uint64_t{surfaces.names.size()});
    for (const std::string& name : surfaces.names) writer.put_text(name);
    return text_message(MessageKind::left_out, writer.bytes);
}

std::string end_message() { return text_message(MessageKind::end, {}); }

std::string solid_message(const CadSolid& solid) {
    Writer writer;
    writer.put(uint64_t{solid.names.size()});
    for (const std::string& name : solid.names) writer.put_text(name);
    writer.put(uint8_t{solid.colour.has_value()});
    writer.put(solid.colour.value_or(Colour{}));
    writer.put(solid.deviation);
    writer.put(solid.gap);
    writer.put(uint8_t{solid.is_proven});
    writer.put_all(solid.mesh.vertices);
    writer.put_all(solid.mesh.triangles);
    return text_message(MessageKind::solid, writer.bytes);
}

std::optional<Message> take_message(std::string_view& output) {
    constexpr size_t head = 1 + sizeof(uint64_t);
    if (output.size() < head) return std::nullopt;
    Reader reader(output);
    Message message{reader.take<MessageKind>(), {}};
    const auto length = reader.take<uint64_t>();
    if (length > output.size() - head) return std::nullopt;
    message.text = output.substr(head, length);
    output.remove_prefix(head + length);
    return message;
}

std::optional<CadProgress> progress_of(std::string_view text) {
    Reader reader(text);
    CadProgress progress;
    progress.step = reader.take_text();
    progress.fraction = reader.take<double>();
    if (!reader.ok || !reader.is_at_end()) return std::nullopt;
    return progress;
}

std::optional<CadSurfaces> left_out_of(std::string_view text) {
    Reader reader(text);
    CadSurfaces surfaces;
    surfaces.what = reader.take_text();
    const auto names = reader.take<uint64_t>();
    for (uint64_t i = 0; reader.ok && i < names; ++i) surfaces.names.push_back(reader.take_text());
    if (!reader.ok || !reader.is_at_end()) return std::nullopt;
    return surfaces;
}

std::optional<CadSolid> solid_of(std::string_view text) {
    Reader reader(text);
    CadSolid solid;
    const auto names = reader.take<uint64_t>();
    for (uint64_t i = 0; reader.ok && i < names; ++i) solid.names.push_back(reader.take_text());
    const bool has_colour = reader.take<uint8_t>() != 0;
    const auto colour = reader.take<Colour>();
    if (has_colour) solid.colour = colour;
    solid.deviation = reader.take<double>();
    solid.gap = reader.take<double>();
    solid.is_proven = reader.take<uint8_t>() != 0;
    solid.mesh.vertices = reader.take_all<Vec3>();
    solid.mesh.triangles = reader.take_all<Mesh::Corners>();
    if (!reader.ok || !reader.is_at_end() || solid.names.empty()) return std::nullopt;
    return solid;
}

} // namespace core::cad
