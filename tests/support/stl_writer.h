#pragma once

#include <cstdint>
#include <string>

#include "core/geom/mesh.h"

namespace test_support {

/// The bytes of a binary STL.
inline std::string binary_stl(const core::Mesh& mesh,
                              const std::string& header = "made by a test") {
    std::string bytes = header;
    bytes.resize(80, ' ');
    const auto put = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<uint32_t>(mesh.triangles.size()));
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        const core::Triangle t = mesh.triangle(i);
        for (const core::Vec3& p : {core::Vec3(0.0), t.a, t.b, t.c})
            for (int k = 0; k < 3; ++k) put(static_cast<float>(p[k]));
        put(uint16_t{0});
    }
    return bytes;
}

/// An ASCII STL with line ends and normals as found in real files.
inline std::string ascii_stl(const core::Mesh& mesh, const std::string& name = "test") {
    std::string text = std::string("solid ").append(name).append("\n");
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
        text += "facet normal 0 0 nan\n outer loop\n";
        const core::Triangle t = mesh.triangle(i);
        for (const core::Vec3& p : {t.a, t.b, t.c})
            text += "  vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " "
                    + std::to_string(p.z) + "\r\n";
        text += " endloop\nendfacet\n";
    }
    return text + "endsolid " + name + "\n";
}

} // namespace test_support
