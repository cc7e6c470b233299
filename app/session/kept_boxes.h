#pragma once

#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

#include "core/dbm/tile_boxes.h"

namespace app {

/// A list in pieces that several may share.
template <typename T>
class SharedPieces {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    static constexpr size_t piece = 64;

    SharedPieces() = default;
    /// Shares the pieces that are the same as in another one.
    SharedPieces(const std::vector<T>& list, const SharedPieces& like) : size_(list.size()) {
        for (size_t first = 0; first < list.size(); first += piece) {
            const size_t count = std::min(piece, list.size() - first);
            const size_t i = pieces_.size();
            const bool is_same =
                i < like.pieces_.size() && like.pieces_[i]->size() == count
                && std::memcmp(like.pieces_[i]->data(), list.data() + first, count * sizeof(T))
                       == 0;
            const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
            pieces_.push_back(is_same ? like.pieces_[i]
                                      : std::make_shared<const std::vector<T>>(
                                          begin, begin + static_cast<std::ptrdiff_t>(count)));
        }
    }

    std::vector<T> whole() const {
        std::vector<T> list;
        list.reserve(size_);
        for (const auto& part : pieces_) list.insert(list.end(), part->begin(), part->end());
        return list;
    }

    /// Bytes that it does not share with another one.
    size_t bytes_apart(const SharedPieces& other) const {
        size_t bytes = pieces_.size() * sizeof(pieces_[0]);
        for (size_t i = 0; i < pieces_.size(); ++i)
            if (i >= other.pieces_.size() || pieces_[i] != other.pieces_[i])
                bytes += pieces_[i]->size() * sizeof(T);
        return bytes;
    }

private:
    std::vector<std::shared_ptr<const std::vector<T>>> pieces_;
    size_t size_ = 0;
};

/// The boxes of a family of lines, to be had again bit for bit.
struct KeptBoxes {
    SharedPieces<core::Aabb> boxes, blocks;
    SharedPieces<core::BoxGap> gaps, block_gaps;
    core::TileBoxes rest; // what is small

    size_t bytes_apart(const KeptBoxes& other) const;
};

/// Takes the boxes out of where they are.
KeptBoxes kept(core::TileBoxes boxes, const KeptBoxes& like);

core::TileBoxes restored(const KeptBoxes& kept);

} // namespace app
