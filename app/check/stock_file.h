#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace core {
struct CutModel;
struct StockMesh;
} // namespace core

namespace app {

/// The forms in which a stock is written: surfaces, or the record of its cuts (.feeler).
enum class MeshForm : uint8_t { stl, ply, record };

/// The form that a file's ending asks for.
///
/// Errors: invalid_value for any other ending, naming the file.
core::Result<MeshForm> mesh_form(const std::string& path);

/// What a saved stock is worth.
struct SavedStock {
    std::string file;
    size_t triangles = 0;
    double error = 0.0;     // mm: the points of the model are this near to the surface
    double mesh_size = 0.0; // mm: between lines this far apart the surface is interpolated
    size_t lost = 0;        // points on details thinner than the mesh size, not in the surface
    size_t moves = 0;       // in a record, which has no triangles and no error
};

/// The same in a line of text.
std::string facts_of(const SavedStock& saved);

struct StockFile {
    SavedStock facts;
    std::string bytes;
};

/// The surface of a stock as a mesh file, in the frame of the stock; its error stands in the file.
/// Scan lines are `mesh_size` apart.
///
/// Errors: those of mesh_form; invalid_value when nothing is left.
core::Result<StockFile> stock_file(const core::StockMesh& surface, double mesh_size,
                                   const std::string& path);

/// The stock as a record from which a later set-up takes it (`[stock] model`), nothing lost.
StockFile stock_record_file(const core::CutModel& stock, const std::string& path);

} // namespace app
