#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace core {
struct CutModel;
struct StockMesh;
} // namespace core

namespace app {

/// File formats of a stock: surfaces (.stl, .ply), or the raw stock with its cuts (.feeler).
enum class MeshForm : uint8_t { stl, ply, record };

/// The format for a file name's extension.
///
/// Errors: invalid_value for another extension, with the file.
core::Result<MeshForm> mesh_form(const std::string& path);

/// Facts about a saved stock.
struct SavedStock {
    std::string file;
    size_t triangles = 0;
    double error = 0.0;     // mm: largest distance of the model's points to the surface
    double mesh_size = 0.0; // mm: spacing of the lines between which the surface is interpolated
    size_t lost = 0;        // points on details thinner than the mesh size, missing in the surface
    size_t moves = 0;       // in a .feeler file, which has no triangles and no error
};

/// The facts as one line of text.
std::string facts_of(const SavedStock& saved);

struct StockFile {
    SavedStock facts;
    std::string bytes;
};

/// The surface of a stock as a mesh file, in the frame of the stock. The file states its error.
///
/// Errors: those of mesh_form; invalid_value if no material is left.
core::Result<StockFile> stock_file(const core::StockMesh& surface, double mesh_size,
                                   const std::string& path);

/// The stock as a .feeler file, exact, for `[stock] model` of a later set-up.
StockFile stock_record_file(const core::CutModel& stock, double path_error,
                            const std::string& path);

} // namespace app
