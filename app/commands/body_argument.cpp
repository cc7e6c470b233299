#include "app/commands/body_argument.h"

#include <charconv>

#include <fmt/format.h>

#include "core/geom/mesh_file.h"

namespace app {
namespace {

core::Result<std::vector<double>> sizes(const std::string& argument, size_t colon, size_t count) {
    std::vector<double> values;
    const char* at = argument.data() + colon + 1;
    const char* const end = argument.data() + argument.size();
    while (true) {
        double value = 0.0;
        const auto [next, failure] = std::from_chars(at, end, value);
        if (failure != std::errc()) break;
        values.push_back(value);
        at = next;
        if (at == end || *at != ',') break;
        ++at;
    }
    if (at == end && values.size() == count) return values;
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("\"{}\" is no body: write sphere:R, box:X,Y,Z or cylinder:R,H "
                                  "with sizes in mm",
                                  argument));
}

core::Result<core::Primitive> primitive(const std::string& argument, size_t colon) {
    const std::string kind = argument.substr(0, colon);
    if (kind == "sphere") {
        FEELER_TRY(const auto s, sizes(argument, colon, 1));
        return core::checked_primitive(core::Sphere{s[0]});
    }
    if (kind == "box") {
        FEELER_TRY(const auto s, sizes(argument, colon, 3));
        return core::checked_primitive(core::Box{{s[0], s[1], s[2]}});
    }
    FEELER_TRY(const auto s, sizes(argument, colon, 2));
    return core::checked_primitive(core::Cylinder{s[0], s[1]});
}

} // namespace

core::Result<NamedBody> body_argument(const std::string& argument) {
    const size_t colon = argument.find(':');
    const std::string kind = argument.substr(0, std::min(colon, argument.size()));
    if (colon != std::string::npos && (kind == "sphere" || kind == "box" || kind == "cylinder")) {
        FEELER_TRY(const core::Primitive body, primitive(argument, colon));
        return NamedBody{argument, body, {}};
    }
    auto read = core::read_mesh(argument);
    if (!read) {
        core::Error error = read.error();
        if (error.file.empty()) error.file = argument;
        return tl::unexpected(error);
    }
    return NamedBody{argument, core::solid_mesh(std::move(read->mesh)), std::move(read->repairs)};
}

} // namespace app
