#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Message_ProgressRange.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>

#include "core/base/result.h"
#include "core/cad/cad_file.h"
#include "core/cad/cad_message.h"
#include "core/geom/mesh.h"

namespace core::cad {

/// A solid of a file, at one of its places.
struct PlacedSolid {
    std::vector<std::string> names; // as in CadSolid
    std::optional<Colour> colour;
    TopoDS_Shape shape; // shared by all places of a part
    gp_Trsf place;      // from the frame of `shape` to that of the file
};

/// The solids of a file.
struct Document {
    std::vector<PlacedSolid> solids;
    std::vector<std::string> notes; // as in CadFile
    std::vector<CadSurfaces> left_out;
};

/// Reads a file with Open CASCADE, which may throw a Standard_Failure.
///
/// `sewing`: faces that belong to no solid are joined across gaps of up to this size, mm.
/// Errors:  as in read_cad, without the file.
Result<Document> read_document(const std::string& path, CadFormat format, double sewing,
                               const Message_ProgressRange& progress);

} // namespace core::cad
