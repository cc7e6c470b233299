#include "core/dbm/cut_ahead.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <tuple>
#include <utility>

#include "core/dbm/tile_cutting.h"

namespace core {

namespace {

constexpr int family_of_shard(size_t shard) { return static_cast<int>(shard % families); }

// A tile is shared again when so many windows have not touched it: a pass of a finishing program
// comes back to a tile many times, and each time both sides would copy it.
constexpr uint32_t windows_to_cool = 32;
constexpr uint32_t windows_between_looks = 16;

} // namespace

struct CutWindow::Contents {
    /// The lower or upper ends of eight neighbouring lines in a layer.
    struct Ends {
        static constexpr size_t size = 8;
        std::array<double, size> at;
        std::array<uint32_t, size> mark;
        std::array<uint8_t, size> tilt;

        Ends(const ScanTile& tile, size_t layer, size_t slot, bool upper) {
            const ScanTile::Layer& from = tile.layers[layer];
            std::memcpy(at.data(), upper ? &from.upper[slot] : &from.lower[slot], sizeof(at));
            if (tile.marks.empty()) return;
            const ScanTile::Marks& marks = tile.marks[layer];
            std::memcpy(mark.data(), upper ? &marks.upper[slot] : &marks.lower[slot], sizeof(mark));
            std::memcpy(tilt.data(), upper ? &marks.upper_tilt[slot] : &marks.lower_tilt[slot],
                        sizeof(tilt));
        }

        void put(ScanTile& tile, size_t layer, size_t slot, bool upper) const {
            ScanTile::Layer& into = tile.layers[layer];
            std::memcpy(upper ? &into.upper[slot] : &into.lower[slot], at.data(), sizeof(at));
            if (tile.marks.empty()) return;
            ScanTile::Marks& marks = tile.marks[layer];
            std::memcpy(upper ? &marks.upper[slot] : &marks.lower[slot], mark.data(), sizeof(mark));
            std::memcpy(upper ? &marks.upper_tilt[slot] : &marks.lower_tilt[slot], tilt.data(),
                        sizeof(tilt));
        }
    };

    /// What a piece of the cutter changed in a tile; its ends follow those of the change before.
    struct TileChange {
        uint32_t tile = 0, piece = 0;
        bool has_marks = false;
        TileOutcome outcome;
        size_t layers = 0; // of the tile
        size_t first_ends = 0;

        /// Calls `act(layer, first slot, is upper)` for the groups of eight ends that are copied.
        template <typename Act>
        void for_ends(const Act& act) const {
            for (size_t layer = 0; layer < layers; ++layer) {
                if (!((outcome.layers >> std::min(layer, size_t{31})) & 1U)) continue;
                for (uint32_t left = outcome.lower_chunks; left != 0; left &= left - 1)
                    act(layer, static_cast<size_t>(std::countr_zero(left)) * Ends::size, false);
                for (uint32_t left = outcome.upper_chunks; left != 0; left &= left - 1)
                    act(layer, static_cast<size_t>(std::countr_zero(left)) * Ends::size, true);
            }
        }

        void make(const Ends* ends, ScanTile& in) const {
            if (in.layers.size() < layers) in.layers.resize(layers);
            if (has_marks) in.keep_marks();
            for_ends([&](size_t layer, size_t slot, bool upper) {
                (ends++)->put(in, layer, slot, upper);
            });
        }
    };

    /// A tile that no move has touched for a long time; `content`: as in the owner's model.
    struct CoolTile {
        uint32_t tile = 0;
        std::shared_ptr<ScanTile> content = {};
    };

    /// The changes of the tiles of one shard.
    struct Shard {
        std::vector<TileChange> changes;
        std::vector<size_t> first_change; // of each move, and their number
        std::vector<Ends> ends;
        std::vector<CoolTile> cooled;
        std::vector<CoolTile> returned; // those of an earlier window, with their contents
    };

    std::vector<CutterSweep> sweeps;
    std::vector<std::optional<ReadySweep>> ready; // empty: it does not come to the stock
    std::vector<Shard> shards;
    std::vector<RemovalSums> removed; // by each move
    uint32_t number = 0;
};

CutWindow::CutWindow() : contents_(std::make_unique<Contents>()) {}
CutWindow::~CutWindow() = default;
size_t CutWindow::size() const { return contents_->sweeps.size(); }
const CutterSweep& CutWindow::sweep(size_t i) const { return contents_->sweeps[i]; }

CutAhead::CutAhead(const CutModel& model, unsigned parts) : warm_(parts * families) {
    // Without what only searches need: that is most of a model besides its tiles.
    model_.outer_box = model.outer_box;
    model_.lines = model.lines;
    model_.columns = model.columns;
    model_.positions = model.positions;
    model_.corners = model.corners;
    model_.last = model.last;
    model_.marks = model.marks;
    for (int family = 0; family < families; ++family) {
        const TileBoxes& from = boxes_of(model, family);
        TileBoxes& boxes = boxes_of(model_, family);
        boxes.u_tiles = from.u_tiles;
        boxes.v_tiles = from.v_tiles;
        boxes.boxes = from.boxes;
        touched_in_[static_cast<size_t>(family)].resize(boxes.boxes.size());
    }
}

double CutAhead::bytes_for(const CutterSweep& sweep) const {
    const Aabb swept = bounds(sweep);
    Vec3 size(0.0);
    for (int axis = 0; axis < 3; ++axis)
        size[axis] = std::max(0.0, std::min(swept.max[axis], model_.outer_box.max[axis])
                                       - std::max(swept.min[axis], model_.outer_box.min[axis]))
                     / model_.lines.grid.spacing;
    const double lines = size.y * size.z + size.z * size.x + 2.0 * size.x * size.y;
    return lines / CutWindow::Contents::Ends::size * sizeof(CutWindow::Contents::Ends);
}

size_t CutAhead::bytes_in(const CutWindow& window) {
    size_t bytes = 0;
    for (const CutWindow::Contents::Shard& shard : window.contents_->shards)
        bytes += shard.ends.size() * sizeof(CutWindow::Contents::Ends)
                 + shard.changes.size() * sizeof(CutWindow::Contents::TileChange);
    return bytes;
}

bool CutAhead::changes_stock(const CutWindow& window, size_t i) {
    const auto& shards = window.contents_->shards;
    return std::any_of(shards.begin(), shards.end(), [&](const auto& shard) {
        return shard.first_change[i] < shard.first_change[i + 1];
    });
}

std::unique_ptr<CutWindow> CutAhead::begin(std::vector<CutterSweep> sweeps,
                                           std::unique_ptr<CutWindow> used) {
    std::unique_ptr<CutWindow> window = used ? std::move(used) : std::make_unique<CutWindow>();
    CutWindow::Contents& contents = *window->contents_;
    contents.number = ++windows_;
    contents.sweeps = std::move(sweeps);
    contents.ready.clear();
    for (const CutterSweep& sweep : contents.sweeps)
        contents.ready.push_back(prepare(model_, sweep));
    contents.shards.resize(shards());
    // One heavy window must not bind its memory for good.
    constexpr size_t much = 4'000'000;
    const bool is_large = bytes_in(*window) > much;
    for (CutWindow::Contents::Shard& shard : contents.shards) {
        std::vector<CutWindow::Contents::CoolTile> cooled = std::exchange(shard.cooled, {});
        if (is_large) shard = {};
        shard.changes.clear();
        shard.first_change.clear();
        shard.ends.clear();
        shard.returned = std::move(cooled);
    }
    return window;
}

void CutAhead::cut(CutWindow& window, unsigned number) {
    CutWindow::Contents& contents = *window.contents_;
    CutWindow::Contents::Shard& shard = contents.shards[number];
    std::vector<uint32_t>& warm = warm_[number];
    const int family = family_of_shard(number);
    const unsigned part = number / families, parts = shards() / families;
    ScanLines& lines = family_of(model_, family);
    TileBoxes& boxes = boxes_of(model_, family);
    std::vector<uint32_t>& touched_in = touched_in_[static_cast<size_t>(family)];
    for (CutWindow::Contents::CoolTile& cool : std::exchange(shard.returned, {}))
        if (touched_in[cool.tile] == 0) lines.put_back(cool.tile, std::move(cool.content));
    const auto across = static_cast<size_t>(boxes.u_tiles);
    const auto mine = [&](size_t tile) {
        return parts == 1 || (tile % across + tile / across) % parts == part;
    };
    const auto note = [&](uint32_t piece, size_t tile, const TileOutcome& outcome) {
        if (outcome.blocks == 0) return;
        if (touched_in[tile] == 0) warm.push_back(static_cast<uint32_t>(tile));
        touched_in[tile] = contents.number;
        const ScanTile& now = *lines.tile(tile);
        shard.changes.push_back({.tile = static_cast<uint32_t>(tile),
                                 .piece = piece,
                                 .has_marks = !now.marks.empty(),
                                 .outcome = outcome,
                                 .layers = now.layers.size(),
                                 .first_ends = shard.ends.size()});
        shard.changes.back().for_ends([&](size_t layer, size_t slot, bool upper) {
            shard.ends.emplace_back(now, layer, slot, upper);
        });
    };
    for (const std::optional<ReadySweep>& ready : contents.ready) {
        shard.first_change.push_back(shard.changes.size());
        if (ready) cut_tiles(model_, family, *ready, mine, note);
    }
    shard.first_change.push_back(shard.changes.size());
    if (contents.number % windows_between_looks != 0) return;
    std::erase_if(warm, [&](uint32_t tile) {
        if (contents.number - touched_in[tile] < windows_to_cool) return false;
        touched_in[tile] = 0;
        boxes.boxes[tile] = fitted_box(boxes, lines, positions_of(model_, family), tile);
        shard.cooled.push_back({tile});
        return true;
    });
}

void CutAhead::finish(CutWindow& window) {
    CutWindow::Contents& contents = *window.contents_;
    contents.removed.assign(window.size(), {});
    struct Part {
        int family;
        const CutWindow::Contents::TileChange* change;
    };
    std::vector<Part> all;
    for (size_t i = 0; i < window.size(); ++i) {
        all.clear();
        for (size_t s = 0; s < contents.shards.size(); ++s) {
            const CutWindow::Contents::Shard& shard = contents.shards[s];
            for (size_t k = shard.first_change[i]; k < shard.first_change[i + 1]; ++k)
                all.push_back({family_of_shard(s), &shard.changes[k]});
        }
        // The order of cut(), so that rounding is the same.
        std::sort(all.begin(), all.end(), [](const Part& a, const Part& b) {
            return std::tie(a.family, a.change->piece, a.change->tile)
                   < std::tie(b.family, b.change->piece, b.change->tile);
        });
        for (const Part& part : all) {
            contents.removed[i].beyond += part.change->outcome.removed.beyond;
            contents.removed[i].points += part.change->outcome.removed.points;
        }
    }
}

double CutAhead::repeat(const CutWindow& window, size_t i, const CutterSweep& sweep,
                        CutModel& model) {
    const CutWindow::Contents& contents = *window.contents_;
    const std::optional<ReadySweep> ready = core::begin(model, sweep);
    if (!ready) return reported(model, {});
    for (size_t s = 0; s < contents.shards.size(); ++s) {
        const CutWindow::Contents::Shard& shard = contents.shards[s];
        const int family = family_of_shard(s);
        for (size_t k = shard.first_change[i]; k < shard.first_change[i + 1]; ++k) {
            const CutWindow::Contents::TileChange& change = shard.changes[k];
            change.make(&shard.ends[change.first_ends],
                        family_of(model, family).edit_tile(change.tile));
            boxes_of(model, family).note(change.tile, change.outcome.blocks);
        }
    }
    fit_when_many_are_stale(model);
    return reported(model, contents.removed[i]);
}

void CutAhead::share(CutWindow& window, const CutModel& model) {
    for (size_t s = 0; s < window.contents_->shards.size(); ++s)
        for (CutWindow::Contents::CoolTile& cool : window.contents_->shards[s].cooled)
            cool.content = family_of(model, family_of_shard(s)).share_tile(cool.tile);
}

double CutReplay::cut(CutModel& model, const CutterSweep& sweep, unsigned threads) {
    if (&model != model_) return core::cut(model, sweep, threads);
    is_lost_ = !foresaw(sweep);
    if (is_lost_) return core::cut(model, sweep, threads);
    const size_t moves = model.log.size();
    const double removed = CutAhead::repeat(*window_, next_, sweep, model);
    // The boxes around the stock may be tighter here than around the copy.
    is_lost_ = model.log.size() == moves && CutAhead::changes_stock(*window_, next_);
    ++next_;
    return removed;
}

void CutReplay::skip(const CutModel& model, const CutterSweep& sweep) {
    if (&model != model_) return;
    is_lost_ = !foresaw(sweep);
    ++next_;
}

} // namespace core
