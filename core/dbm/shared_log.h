#pragma once

#include <memory>
#include <vector>

#include "core/dbm/cutter.h"

namespace core {

/// A list that only grows, in chunks that copies share: a copy costs a pointer per chunk.
template <typename T>
class SharedLog {
public:
    static constexpr size_t chunk_size = 64;

    size_t size() const { return size_; }
    const T& operator[](size_t i) const { return (*chunks_[i / chunk_size])[i % chunk_size]; }

    void push_back(const T& value) {
        if (size_ % chunk_size == 0)
            chunks_.push_back(std::make_shared<std::vector<T>>());
        else if (chunks_.back().use_count() > 1)
            chunks_.back() = std::make_shared<std::vector<T>>(*chunks_.back());
        chunks_.back()->push_back(value);
        ++size_;
    }

private:
    std::vector<std::shared_ptr<std::vector<T>>> chunks_;
    size_t size_ = 0;
};

/// One move of a cutter that was carried out, with the box of what it may have removed.
struct LoggedSweep {
    CutterSweep sweep;
    Aabb box;
};

} // namespace core
