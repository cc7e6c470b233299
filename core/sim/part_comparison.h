#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace core {

struct CutModel;
struct Part;
struct StockMesh;

/// gouge: the part has matter where nothing is left. excess: something is left outside of the part.
enum class Deviation : uint8_t { gouge, excess };

const char* name_of(Deviation deviation);

/// A connected region of the surface that is off the part by more than the tolerance.
struct DeviationRegion {
    Deviation kind = Deviation::gouge;
    double amount = 0.0;           // the greatest, mm
    Vec3 place = Vec3(0.0);        // of it, in the stock's frame
    double area = 0.0;             // mm2
    std::optional<uint32_t> block; // that made the surface there; empty: raw stock
};

/// A stock held against the part.
struct PartComparison {
    double largest_gouge = 0.0; // mm; 0 when there is none
    double largest_excess = 0.0;
    /// No point of either surface is farther than this from one that was measured, mm: what lies
    /// between them may be off by as much more.
    double between_samples = 0.0;
    size_t samples = 0;
    std::vector<DeviationRegion> regions; // the worst first, gouges before excess
    std::vector<double>
        deviations; // of each vertex of the stock's mesh: excess above 0, gouge below
};

/// Compares what is left of a stock with the part.
///
/// The true points of the stock's surface on the scan lines are measured to the part's triangles,
/// and points all over the part's surface, about a mesh size apart, to the stock's: so also what is
/// gone altogether is seen. Excess is the distance of a point of the stock to the part, a gouge
/// that of a point of the part to the stock; within a gouge, points of the stock's surface are as
/// deep in the part as they are far from its surface.
PartComparison compare_with_part(const CutModel& stock, const StockMesh& surface, const Part& part);

} // namespace core
