#pragma once

#include <memory>
#include <vector>

namespace core {

/// A list that only grows, but for its last element, in chunks that copies share: a copy costs a
/// pointer per chunk.
template <typename T>
class SharedLog {
public:
    static constexpr size_t chunk_size = 64;

    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const T& operator[](size_t i) const { return (*chunks_[i / chunk_size])[i % chunk_size]; }
    const T& back() const { return (*this)[size_ - 1]; }

    void push_back(const T& value) {
        if (size_ % chunk_size == 0)
            chunks_.push_back(std::make_shared<std::vector<T>>());
        else
            own_last_chunk();
        chunks_.back()->push_back(value);
        ++size_;
    }
    void replace_back(const T& value) {
        own_last_chunk();
        chunks_.back()->back() = value;
    }

private:
    void own_last_chunk() {
        if (chunks_.back().use_count() > 1)
            chunks_.back() = std::make_shared<std::vector<T>>(*chunks_.back());
    }

    std::vector<std::shared_ptr<std::vector<T>>> chunks_;
    size_t size_ = 0;
};

} // namespace core
