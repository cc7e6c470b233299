#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <TopoDS_Shape.hxx>

#include "core/base/vec.h"

namespace test_support {

/// A body made with Open CASCADE.
struct CadModel {
    std::string name;
    std::function<TopoDS_Shape()> make;
};

/// Bodies with every kind of surface that Open CASCADE knows.
std::vector<CadModel> cad_models();

TopoDS_Shape cad_box(const core::Vec3& low, const core::Vec3& high);
TopoDS_Shape cad_cylinder(double radius, double height);
TopoDS_Shape cad_moved(const TopoDS_Shape& shape, const core::Vec3& by);
TopoDS_Shape cad_turned(const TopoDS_Shape& shape, const core::Vec3& axis, double degrees);

/// All shapes as one.
TopoDS_Shape cad_compound(const std::vector<TopoDS_Shape>& shapes);

/// The surface of a shape without some of its faces, as an open shell.
TopoDS_Shape cad_open_shell(const TopoDS_Shape& shape, size_t missing);

/// The edges of a shape.
TopoDS_Shape cad_wires(const TopoDS_Shape& shape);

/// The exact distance from a point to a shape; 0 inside a solid.
double cad_distance(const TopoDS_Shape& shape, const core::Vec3& point);

/// Points of the faces of a shape, `count` x `count` for the parameters of each face.
std::vector<core::Vec3> cad_surface_points(const TopoDS_Shape& shape, int count);

/// A part of an assembly: a name, a shape and where it is.
struct CadPart {
    std::string name;
    TopoDS_Shape shape;
    core::Vec3 at = core::Vec3(0.0);
    double turned = 0.0; // about Z, degrees
    std::vector<CadPart> parts = {};
    std::optional<std::array<double, 3>> colour = {};
};

/// Writes files; `unit` is that of Open CASCADE: "MM", "INCH", "M".
void write_step(const std::filesystem::path& path, const TopoDS_Shape& shape,
                const std::string& unit = "MM");
void write_step(const std::filesystem::path& path, const CadPart& assembly);
void write_iges(const std::filesystem::path& path, const TopoDS_Shape& shape, bool as_solid);

} // namespace test_support
