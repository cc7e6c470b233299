#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct CutModel;
struct Part;
struct StockMesh;

/// gouge: the part has material where the stock has none. excess: material is left outside the
/// part.
enum class Deviation : uint8_t { gouge, excess };

const char* name_of(Deviation deviation);

/// A connected region of the surface that deviates from the part by more than Part::limit.
struct DeviationRegion {
    Deviation kind = Deviation::gouge;
    double amount = 0.0;           // largest deviation in the region, mm
    Vec3 position = Vec3(0.0);     // of the largest deviation, in the stock's frame
    double area = 0.0;             // mm2
    std::optional<uint32_t> block; // that cut the surface there; empty: raw stock
};

/// The result of comparing a stock with the part.
struct PartComparison {
    double largest_gouge = 0.0; // mm; 0 if there is none
    double largest_excess = 0.0;
    /// Largest distance from any point of either surface to the nearest measured point, mm. Between
    /// measured points, deviations may be larger by this amount.
    double between_samples = 0.0;
    size_t samples = 0;
    std::vector<DeviationRegion>
        regions; // gouges before excess, each sorted from largest to smallest
    std::vector<double>
        deviations; // for each vertex of the stock's mesh: excess above 0, gouge below
};

/// Compares the remaining stock with the part.
///
/// Measures the distance of the exact points of the stock's surface on the scan lines from the
/// part's triangles, and of points on the part's surface, about a mesh size apart, from the stock's
/// triangles. The latter finds features that were cut away completely. An excess is the distance of
/// a point of the stock from the part; a gouge is that of a point of the part from the stock.
/// Within a gouge, the depth of a stock point is its distance from the part's surface.
PartComparison compare_with_part(const CutModel& stock, const StockMesh& surface, const Part& part);

} // namespace core
