#include "app/session/part_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/geom/mesh_bytes.h"
#include "core/sim/bound_text.h"
#include "core/sim/finding_text.h"

namespace app {
namespace {

/// Regions beyond these are counted, not told one by one.
constexpr size_t most_findings = 10;

core::Finding finding_of(const core::DeviationRegion& region) {
    const bool gouge = region.kind == core::Deviation::gouge;
    core::Finding finding;
    finding.rule = gouge ? "gouge" : "rest-material";
    if (region.block) finding.block = core::BlockIndex{*region.block};
    const std::string where =
        fmt::format("at X {:.3f} Y {:.3f} Z {:.3f} of the stock, over some {:.1f} mm2",
                    region.place.x, region.place.y, region.place.z, region.area);
    finding.message =
        fmt::format("{} mm {} {}.", core::at_most(region.amount),
                    gouge ? "of the part are missing" : "more than the part are left", where);
    if (gouge)
        finding.cure = region.block
                           ? "Look at the path, the tool's sizes and the offsets of this block."
                           : "The raw stock does not hold the part here: a larger stock, or "
                             "another place for the part.";
    finding.shortfall = region.amount;
    return finding;
}

void add(CheckRun& run, core::Finding finding) {
    finding.severity = core::severity_of(run.setup, finding.rule);
    if (finding.severity != core::Severity::off) run.findings.push_back(std::move(finding));
}

void add_findings(CheckRun& run, core::Deviation kind) {
    size_t told = 0, more = 0;
    for (const core::DeviationRegion& region : run.comparison->regions) {
        if (region.kind != kind) continue;
        if (told++ < most_findings)
            add(run, finding_of(region));
        else
            ++more;
    }
    if (more == 0) return;
    core::Finding finding;
    finding.rule = kind == core::Deviation::gouge ? "gouge" : "rest-material";
    finding.message = fmt::format("{} more regions are off the part by less than that.", more);
    add(run, finding);
}

/// Green within the tolerance; from yellow to red where the part is gouged, from cyan to blue where
/// too much is left, at five times the tolerance and beyond.
core::Colour colour_of(double deviation, double tolerance) {
    const double off = std::abs(deviation);
    if (off <= tolerance) return {80, 170, 80};
    const double share = std::clamp((off - tolerance) / (4.0 * tolerance), 0.0, 1.0);
    const auto fading = static_cast<uint8_t>(220.0 * (1.0 - share));
    if (deviation < 0.0) return {230, fading, 0};
    return {0, fading, 230};
}

} // namespace

void check_part(CheckRun& run) {
    if (!run.setup.part || !run.surface) return;
    run.comparison = core::compare_with_part(*run.stock, *run.surface, *run.setup.part);
    add_findings(run, core::Deviation::gouge);
    add_findings(run, core::Deviation::excess);
}

std::string facts_of(const core::PartComparison& comparison, double tolerance) {
    return fmt::format(
        "missing up to {} mm, left over up to {} mm; {} beyond {} mm; "
        "measured every {} mm",
        core::at_most(comparison.largest_gouge), core::at_most(comparison.largest_excess),
        comparison.regions.size() == 1 ? "1 region"
                                       : fmt::format("{} regions", comparison.regions.size()),
        tolerance, core::at_most_figures(comparison.between_samples, 2));
}

core::Result<std::string> comparison_file(const CheckRun& run, const std::string& path) {
    const auto refused = [&](const std::string& why) {
        return tl::unexpected<core::Error>({core::ErrorCode::invalid_value, {}, why, path});
    };
    FEELER_TRY(const MeshForm form, mesh_form(path));
    if (form != MeshForm::ply) return refused("cannot hold colours: the name must end in .ply");
    if (!run.comparison)
        return refused("was not written: the set-up has no [part] to compare with");
    if (run.surface->mesh.triangles.empty())
        return refused("was not written: nothing is left of the stock");
    const double tolerance = run.setup.part->tolerance;
    std::vector<core::Colour> colours;
    for (const double deviation : run.comparison->deviations)
        colours.push_back(colour_of(deviation, tolerance));
    return core::ply_bytes(
        run.surface->mesh,
        {"what is left of the stock beside the part, by feeler; mm, in the frame of the stock",
         fmt::format("green: within {} mm of the part", tolerance),
         fmt::format("yellow to red: part missing, {} to {} mm and more", tolerance,
                     5.0 * tolerance),
         fmt::format("cyan to blue: left over, {} to {} mm and more", tolerance, 5.0 * tolerance),
         fmt::format("colours are the worst beside each corner; measured every {} mm",
                     core::at_most_figures(run.comparison->between_samples, 2))},
        colours);
}

} // namespace app
