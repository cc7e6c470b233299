#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "app/check/check_run.h"
#include "core/sim/run/block_clock.h"

namespace app {
namespace {

// What the packed form of a block contains, as bits of its second byte. The first byte is the
// motion, and the verdict times 16.
enum Content : uint8_t {
    is_checked = 1,
    has_tool = 2,
    has_deciding = 4,
    has_file = 8,
    has_calls = 16,
    has_findings = 32,
    has_own_index = 64, // that is not the number of blocks before it
    has_removed = 128,
};

// Bits of the first byte of a pair, besides the verdict.
enum PairContent : uint8_t { unless_removed = 16, has_witness = 32, is_exact = 64 };
constexpr uint8_t verdict_bits = 15;

template <typename Value>
void put(std::vector<uint8_t>& bytes, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    const size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(&bytes[at], &value, sizeof value);
}

/// A whole number in seven bits per byte, the lowest first; the eighth bit says that more follow.
void put_number(std::vector<uint8_t>& bytes, uint64_t number) {
    for (; number >= 128; number >>= 7U) bytes.push_back(static_cast<uint8_t>(number | 128U));
    bytes.push_back(static_cast<uint8_t>(number));
}

// The characters of which most NC blocks consist take four bits each, others twelve.
constexpr std::string_view short_characters = "0123456789.- XY";
constexpr unsigned long_character = 15; // comes before the eight bits of another one

constexpr std::array<uint8_t, 256> short_codes = [] {
    std::array<uint8_t, 256> codes{};
    codes.fill(long_character);
    for (size_t i = 0; i < short_characters.size(); ++i)
        codes[static_cast<uint8_t>(short_characters[i])] = static_cast<uint8_t>(i);
    return codes;
}();

void put_text(std::vector<uint8_t>& bytes, std::string_view text) {
    put_number(bytes, text.size());
    bool is_half = false; // the last byte has four bits left
    const auto put_half = [&](unsigned bits) {
        if (is_half)
            bytes.back() = static_cast<uint8_t>(bytes.back() | bits << 4U);
        else
            bytes.push_back(static_cast<uint8_t>(bits));
        is_half = !is_half;
    };
    for (const char character : text) {
        const auto code = static_cast<uint8_t>(character);
        put_half(short_codes[code]);
        if (short_codes[code] != long_character) continue;
        put_half(code & 15U);
        put_half(code >> 4U);
    }
}

class Reader {
public:
    explicit Reader(const uint8_t* at) : at_(at) {}

    template <typename Value>
    Value take() {
        Value value;
        std::memcpy(&value, at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    uint64_t take_number() {
        uint64_t number = 0;
        for (unsigned shift = 0;; shift += 7) {
            const uint8_t byte = *at_++;
            number |= static_cast<uint64_t>(byte & 127U) << shift;
            if (byte < 128) return number;
        }
    }
    void take_text(std::string& text) {
        text.resize(static_cast<size_t>(take_number()));
        bool is_half = false;
        const auto take_half = [&]() -> unsigned {
            is_half = !is_half;
            return is_half ? *at_ & 15U : static_cast<unsigned>(*at_++ >> 4U);
        };
        for (char& character : text) {
            const unsigned code = take_half();
            if (code != long_character) {
                character = short_characters[code];
                continue;
            }
            const unsigned low = take_half();
            character = static_cast<char>(low | take_half() << 4U);
        }
        if (is_half) ++at_;
    }

    const uint8_t* at() const { return at_; }

private:
    const uint8_t* at_;
};

bool has_bits(uint8_t content, uint8_t bits) { return (content & bits) != 0; }

/// Whether two numbers are the same to the last bit, so that a negative zero is kept.
bool are_same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

bool is_without_witness(const core::PairClearance& pair) {
    const core::PairClearance none;
    return are_same(pair.upper, none.upper) && are_same(pair.time, none.time)
           && std::memcmp(&pair.on_tool, &none.on_tool, sizeof none.on_tool) == 0
           && std::memcmp(&pair.on_body, &none.on_body, sizeof none.on_body) == 0;
}

} // namespace

uint64_t CheckedBlocks::kind_of(const core::PairClearance& pair) {
    const auto known = std::find_if(kinds_.begin(), kinds_.end(), [&](const PairKind& kind) {
        return kind.pair == pair.pair && are_same(kind.allowance.distance, pair.allowance.distance)
               && are_same(kind.allowance.contact, pair.allowance.contact);
    });
    const auto number = static_cast<uint64_t>(known - kinds_.begin());
    if (known == kinds_.end()) kinds_.push_back({pair.pair, pair.allowance});
    return number;
}

void CheckedBlocks::pack_pair(const core::PairClearance& pair, std::vector<uint8_t>& bytes) {
    const bool is_whole = !is_without_witness(pair),
               has_one_bound = are_same(pair.upper, pair.lower);
    bytes.push_back(static_cast<uint8_t>(
        static_cast<uint8_t>(pair.verdict) | (pair.unless_removed ? unless_removed : 0)
        | (is_whole ? has_witness : 0) | (has_one_bound ? is_exact : 0)));
    put_number(bytes, kind_of(pair));
    put(bytes, pair.lower);
    if (!is_whole) return;
    if (!has_one_bound) put(bytes, pair.upper);
    put(bytes, pair.on_tool);
    put(bytes, pair.on_body);
    put(bytes, pair.time);
}

void CheckedBlocks::pack(const CheckedBlock& block, size_t i, std::vector<uint8_t>& bytes) {
    const core::BlockResult& result = block.result;
    const auto when = [](bool is_so, Content bit) { return is_so ? bit : 0; };
    bytes.push_back(static_cast<uint8_t>(static_cast<unsigned>(result.motion)
                                         | static_cast<unsigned>(result.verdict) << 4U));
    bytes.push_back(static_cast<uint8_t>(
        when(result.checked, is_checked) | when(result.tool.has_value(), has_tool)
        | when(result.deciding.has_value(), has_deciding) | when(!block.file.empty(), has_file)
        | when(!block.calls.empty(), has_calls) | when(!result.findings.empty(), has_findings)
        | when(core::value_of(block.block) != i, has_own_index)
        | when(!are_same(result.removed, 0.0), has_removed)));
    put(bytes, result.time);
    put(bytes, result.duration);
    put_number(bytes, block.line);
    if (core::value_of(block.block) != i) put_number(bytes, core::value_of(block.block));
    if (result.tool) put(bytes, *result.tool);
    if (!are_same(result.removed, 0.0)) put(bytes, result.removed);
    if (!block.file.empty()) {
        const auto known = std::find(files_.begin(), files_.end(), block.file);
        put_number(bytes, static_cast<uint64_t>(known - files_.begin()));
        if (known == files_.end()) files_.push_back(block.file);
    }
    if (!block.calls.empty()) {
        const auto [known, is_new] = call_numbers_.try_emplace(block.calls, calls_.size());
        if (is_new) calls_.push_back(block.calls);
        put_number(bytes, known->second);
    }
    if (result.findings.empty())
        findings_.erase(i);
    else
        findings_[i] = result.findings;
    put_number(bytes, result.pairs.size());
    for (const core::PairClearance& pair : result.pairs) pack_pair(pair, bytes);
    if (result.deciding) put_number(bytes, *result.deciding);
    put_text(bytes, block.text); // last, so that settle_time need not read it
}

void CheckedBlocks::unpack(size_t i, CheckedBlock& block, bool with_text) const {
    assert(i < size_);
    const Chunk& chunk = chunks_[i / chunk_size];
    Reader from(&chunk.bytes[chunk.starts[i % chunk_size]]);
    core::BlockResult& result = block.result;
    const auto kinds = from.take<uint8_t>(), content = from.take<uint8_t>();
    result.motion = static_cast<core::BlockMotion>(kinds & 15U);
    result.verdict = static_cast<core::Verdict>(kinds >> 4U);
    result.checked = has_bits(content, is_checked);
    result.time = from.take<double>();
    result.duration = from.take<double>();
    block.line = static_cast<uint32_t>(from.take_number());
    block.block = core::BlockIndex{
        static_cast<uint32_t>(has_bits(content, has_own_index) ? from.take_number() : i)};
    result.tool.reset();
    if (has_bits(content, has_tool)) result.tool = from.take<core::ToolNumber>();
    result.removed = has_bits(content, has_removed) ? from.take<double>() : 0.0;
    block.file.clear();
    if (has_bits(content, has_file)) block.file = files_[static_cast<size_t>(from.take_number())];
    block.calls.clear();
    if (has_bits(content, has_calls)) block.calls = calls_[static_cast<size_t>(from.take_number())];
    result.findings.clear();
    if (has_bits(content, has_findings)) result.findings = findings_.at(i);
    result.pairs.resize(static_cast<size_t>(from.take_number()));
    for (core::PairClearance& pair : result.pairs) {
        const auto bits = from.take<uint8_t>();
        const PairKind& kind = kinds_[static_cast<size_t>(from.take_number())];
        pair = {.pair = kind.pair, .allowance = kind.allowance};
        pair.verdict = static_cast<core::Verdict>(bits & verdict_bits);
        pair.unless_removed = has_bits(bits, unless_removed);
        pair.lower = from.take<double>();
        if (!has_bits(bits, has_witness)) continue;
        pair.upper = has_bits(bits, is_exact) ? pair.lower : from.take<double>();
        pair.on_tool = from.take<core::Vec3>();
        pair.on_body = from.take<core::Vec3>();
        pair.time = from.take<double>();
    }
    result.deciding.reset();
    if (has_bits(content, has_deciding)) result.deciding = static_cast<size_t>(from.take_number());
    if (with_text)
        from.take_text(block.text);
    else
        block.text.clear();
}

CheckedBlock CheckedBlocks::operator[](size_t i) const {
    CheckedBlock block;
    unpack(i, block, true);
    return block;
}

uint32_t CheckedBlocks::line(size_t i) const {
    assert(i < size_);
    const Chunk& chunk = chunks_[i / chunk_size];
    constexpr size_t before = 2 + 2 * sizeof(double); // kinds, content, time and duration
    return static_cast<uint32_t>(
        Reader(&chunk.bytes[chunk.starts[i % chunk_size] + before]).take_number());
}

void CheckedBlocks::push_back(const CheckedBlock& block) {
    if (size_ % chunk_size == 0) {
        // With room for a chunk like the last one: memory that grows step by step leaves gaps.
        const size_t like_last = chunks_.empty() ? 0 : chunks_.back().bytes.size();
        if (!chunks_.empty()) chunks_.back().bytes.shrink_to_fit();
        chunks_.emplace_back();
        chunks_.back().bytes.reserve(like_last + like_last / 16);
        chunks_.back().starts.reserve(chunk_size);
    }
    Chunk& chunk = chunks_.back();
    chunk.starts.push_back(static_cast<uint32_t>(chunk.bytes.size()));
    pack(block, size_, chunk.bytes);
    ++size_;
}

void CheckedBlocks::replace(size_t i, const CheckedBlock& block) {
    assert(i < size_);
    Chunk& chunk = chunks_[i / chunk_size];
    const size_t slot = i % chunk_size;
    const auto begin = chunk.bytes.begin() + chunk.starts[slot];
    const auto end = slot + 1 < chunk.starts.size() ? chunk.bytes.begin() + chunk.starts[slot + 1]
                                                    : chunk.bytes.end();
    scratch_.clear();
    pack(block, i, scratch_);
    if (const auto size = static_cast<size_t>(end - begin); scratch_.size() == size) {
        std::copy(scratch_.begin(), scratch_.end(), begin);
    } else {
        const auto longer = static_cast<uint32_t>(scratch_.size() - size); // modulo 2^32
        chunk.bytes.insert(chunk.bytes.erase(begin, end), scratch_.begin(), scratch_.end());
        for (size_t later = slot + 1; later < chunk.starts.size(); ++later)
            chunk.starts[later] += longer;
    }
}

void CheckedBlocks::settle_time(size_t i, const core::BlockTime& time) {
    assert(i < size_);
    Chunk& chunk = chunks_[i / chunk_size];
    uint8_t* const begin = &chunk.bytes[chunk.starts[i % chunk_size]];
    uint8_t* const times = begin + 2; // start and duration
    const uint8_t content = begin[1];
    core::BlockResult result; // of what depends on the time
    std::memcpy(&result.duration, times + sizeof(double), sizeof(double));
    Reader from(times + 2 * sizeof(double));
    from.take_number(); // the line
    if (has_bits(content, has_own_index)) from.take_number();
    if (has_bits(content, has_tool)) from.take<core::ToolNumber>();
    if (has_bits(content, has_removed)) from.take<double>();
    if (has_bits(content, has_file)) from.take_number();
    if (has_bits(content, has_calls)) from.take_number();
    result.pairs.resize(static_cast<size_t>(from.take_number()));
    std::vector<uint8_t*> places; // of the times of pairs
    for (core::PairClearance& pair : result.pairs) {
        const auto bits = from.take<uint8_t>();
        from.take_number();
        from.take<double>();
        places.push_back(nullptr);
        if (!has_bits(bits, has_witness)) continue;
        if (!has_bits(bits, is_exact)) from.take<double>();
        from.take<core::Vec3>();
        from.take<core::Vec3>();
        places.back() = begin + (from.at() - begin);
        pair.time = from.take<double>();
    }
    core::settle_time(result, time);
    for (size_t k = 0; k < places.size(); ++k) {
        const double settled = result.pairs[k].time;
        // Without a witness there is no place for a time.
        if (!places[k] && !are_same(settled, 0.0))
            return change(i, [&](CheckedBlock& block) { core::settle_time(block.result, time); });
    }
    std::memcpy(times, &result.time, sizeof(double));
    std::memcpy(times + sizeof(double), &result.duration, sizeof(double));
    for (size_t k = 0; k < places.size(); ++k)
        if (places[k]) std::memcpy(places[k], &result.pairs[k].time, sizeof(double));
}

void CheckedBlocks::truncate(size_t size) {
    assert(size <= size_);
    size_ = size;
    findings_.erase(findings_.lower_bound(size), findings_.end());
    chunks_.resize((size + chunk_size - 1) / chunk_size);
    if (size % chunk_size == 0) return;
    Chunk& last = chunks_.back();
    if (last.starts.size() == size % chunk_size) return;
    last.bytes.resize(last.starts[size % chunk_size]);
    last.starts.resize(size % chunk_size);
}

} // namespace app
