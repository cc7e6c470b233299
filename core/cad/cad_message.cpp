#include "core/cad/cad_message.h"

#include <cstring>
#include <type_traits>
#include <vector>

#include "core/base/byte_record.h"

namespace core::cad {

namespace {

class Writer : public ByteWriter {
public:
    void put_text(std::string_view text) {
        put(uint64_t{text.size()});
        bytes.append(text);
    }
    template <typename Value>
    void put_all(const std::vector<Value>& values) {
        put_text({reinterpret_cast<const char*>(values.data()), sizeof(Value) * values.size()});
    }
};

class Reader : public ByteReader {
public:
    using ByteReader::ByteReader;

    std::string take_text() { return std::string(take_bytes(take<uint64_t>())); }
    template <typename Value>
    std::vector<Value> take_all() {
        static_assert(std::is_trivially_copyable_v<Value>);
        const std::string_view bytes = take_bytes(take<uint64_t>());
        ok = ok && bytes.size() % sizeof(Value) == 0;
        std::vector<Value> values(ok ? bytes.size() / sizeof(Value) : 0);
        if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    std::vector<std::string> take_texts() {
        std::vector<std::string> texts(take_count(sizeof(uint64_t)));
        for (std::string& text : texts) text = take_text();
        return texts;
    }
};

void put_texts(Writer& writer, const std::vector<std::string>& texts) {
    writer.put(uint64_t{texts.size()});
    for (const std::string& text : texts) writer.put_text(text);
}

} // namespace

std::string_view name_of(CadFormat format) {
    switch (format) {
    case CadFormat::step:
        return "step";
    case CadFormat::iges:
        return "iges";
    case CadFormat::brep:
        return "brep";
    case CadFormat::freecad:
        return "freecad";
    }
    return {};
}

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
    put_texts(writer, surfaces.names);
    return text_message(MessageKind::left_out, writer.bytes);
}

std::string end_message() { return text_message(MessageKind::end, {}); }

std::string solid_message(const CadSolid& solid) {
    Writer writer;
    put_texts(writer, solid.names);
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
    surfaces.names = reader.take_texts();
    if (!reader.ok || !reader.is_at_end()) return std::nullopt;
    return surfaces;
}

std::optional<CadSolid> solid_of(std::string_view text) {
    Reader reader(text);
    CadSolid solid;
    solid.names = reader.take_texts();
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
