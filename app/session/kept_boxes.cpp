#include "app/session/kept_boxes.h"

#include <utility>

namespace app {

size_t KeptBoxes::bytes_apart(const KeptBoxes& other) const {
    size_t bytes = boxes.bytes_apart(other.boxes) + blocks.bytes_apart(other.blocks)
                   + gaps.bytes_apart(other.gaps) + block_gaps.bytes_apart(other.block_gaps)
                   + rest.stale.size() * sizeof(uint16_t)
                   + rest.stale_tiles.size() * sizeof(uint32_t);
    for (const core::TileLevel& level : rest.above)
        bytes += level.boxes.size() * sizeof(core::Aabb);
    return bytes;
}

KeptBoxes kept(core::TileBoxes boxes, const KeptBoxes& like) {
    KeptBoxes kept;
    kept.boxes = {std::exchange(boxes.boxes, {}), like.boxes};
    kept.blocks = {std::exchange(boxes.blocks, {}), like.blocks};
    kept.gaps = {std::exchange(boxes.gaps, {}), like.gaps};
    kept.block_gaps = {std::exchange(boxes.block_gaps, {}), like.block_gaps};
    kept.rest = std::move(boxes);
    return kept;
}

core::TileBoxes restored(const KeptBoxes& kept) {
    core::TileBoxes boxes = kept.rest;
    boxes.boxes = kept.boxes.whole();
    boxes.blocks = kept.blocks.whole();
    boxes.gaps = kept.gaps.whole();
    boxes.block_gaps = kept.block_gaps.whole();
    return boxes;
}

} // namespace app
