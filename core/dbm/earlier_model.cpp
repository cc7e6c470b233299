#include "core/dbm/earlier_model.h"

#include "core/dbm/tile_cutting.h"

namespace core {
namespace {

/// The tiles of each family that some moves may have changed.
class ChangedTiles {
public:
    ChangedTiles(const CutModel& model, size_t first_move) {
        for (int family = 0; family < families; ++family)
            is_changed_[static_cast<size_t>(family)].resize(boxes_of(model, family).boxes.size());
        for (size_t i = first_move; i < model.log.size(); ++i) add(model, model.log.box(i));
    }

    bool contains(int family, size_t tile) const {
        return is_changed_[static_cast<size_t>(family)][tile];
    }

    /// Whether a move within a box may have changed one of them.
    bool meets(const CutModel& model, const Aabb& box) const {
        for (int family = 0; family < families; ++family) {
            bool met = false;
            for_tiles(range_of(model, family, box), boxes_of(model, family),
                      [&](size_t tile) { met = met || contains(family, tile); });
            if (met) return true;
        }
        return false;
    }

    /// Calls `act(family, tile)` for each.
    template <typename Act>
    void for_each(const Act& act) const {
        for (int family = 0; family < families; ++family)
            for (const size_t tile : tiles_[static_cast<size_t>(family)]) act(family, tile);
    }

private:
    void add(const CutModel& model, const Aabb& box) {
        for (int family = 0; family < families; ++family) {
            std::vector<bool>& changed = is_changed_[static_cast<size_t>(family)];
            if (changed.empty()) continue; // no columns
            for_tiles(range_of(model, family, box), boxes_of(model, family), [&](size_t tile) {
                if (changed[tile]) return;
                changed[tile] = true;
                tiles_[static_cast<size_t>(family)].push_back(tile);
            });
        }
    }

    std::array<std::vector<bool>, families> is_changed_;
    std::array<std::vector<size_t>, families> tiles_;
};

} // namespace

std::optional<CutModel> earlier_model(const CutModel& model, const CutModel& raw, size_t moves,
                                      size_t most) {
    const ChangedTiles changed(model, moves);
    std::vector<size_t> again;
    for (size_t i = 0; i < moves; ++i)
        if (changed.meets(model, model.log.box(i))) again.push_back(i);
    if (again.size() > most) return std::nullopt;

    CutModel earlier = model;
    earlier.log.keep_first(moves);
    earlier.last = moves > 0 ? model.log[moves - 1].sweep : CutterSweep{};
    earlier.volume_owed = 0.0;
    changed.for_each([&](int family, size_t tile) {
        family_of(earlier, family).put_back(tile, family_of(raw, family).share_tile(tile));
        boxes_of(earlier, family).note(tile, 0xffff);
        if (family != column_family) return;
        SharedLog<SweepRun>& history = earlier.history[tile];
        while (!history.empty() && history.back().last >= moves) remove_newest(history);
    });
    fit_boxes(earlier);
    for (const size_t i : again) {
        const LoggedSweep logged = earlier.log[i];
        // The whole cutter: nobody knows whether the move went on from the one before it.
        const ReadySweep ready{&logged.sweep, logged.box, earlier.log.mark(i)};
        for (int family = 0; family < families; ++family)
            cut_tiles(
                earlier, family, ready, [&](size_t tile) { return changed.contains(family, tile); },
                [&](uint32_t, size_t tile, const TileOutcome& outcome) {
                    boxes_of(earlier, family).note(tile, outcome.blocks);
                });
    }
    fit_boxes(earlier);
    return earlier;
}

} // namespace core
