#include "app/batch/shard.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace app {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t most_shares = 1'000'000;

core::Error refusal(const std::string& file, std::string why) {
    return {core::ErrorCode::invalid_value, {}, std::move(why), file};
}

std::string text_of(const ShareName& share) { return fmt::format("{}/{}", share.i, share.n); }

/// Why a shard belongs to another batch than the first; empty if it does not.
std::string difference(const Shard& first, const Shard& other) {
    const auto differs = [&](const char* what) {
        return fmt::format("belongs to another batch than {}: {}", first.file, what);
    };
    if (other.version != first.version) return differs("another version of Feeler made it");
    if (other.share.n != first.share.n)
        return differs(
            fmt::format("it is share {}, not one of {}", text_of(other.share), first.share.n)
                .c_str());
    if (other.programs != first.programs) return differs("its list of programs is another");
    if (other.options != first.options) return differs("its options are others");
    return {};
}

core::Result<void> check_shares(const std::vector<Shard>& shards) {
    for (size_t i = 1; i < shards.size(); ++i) {
        if (const std::string why = difference(shards[0], shards[i]); !why.empty())
            return tl::unexpected(refusal(shards[i].file, why));
        if (shards[i].share == shards[i - 1].share)
            return tl::unexpected(
                refusal(shards[i].file, fmt::format("is share {}, and so is {}",
                                                    text_of(shards[i].share), shards[i - 1].file)));
    }
    std::vector<std::string> missing;
    size_t next = 1;
    for (const Shard& shard : shards) {
        for (; next < shard.share.i; ++next) missing.push_back(text_of({next, shard.share.n}));
        ++next;
    }
    for (; next <= shards[0].share.n; ++next) missing.push_back(text_of({next, shards[0].share.n}));
    if (missing.empty()) return {};
    return core::fail(core::ErrorCode::missing_value,
                      fmt::format("{} missing: {}",
                                  missing.size() == 1 ? "a share is" : "these shares are",
                                  fmt::join(missing, ", ")));
}

} // namespace

std::vector<size_t> share_of(std::span<const uintmax_t> sizes, size_t i, size_t n) {
    std::vector<size_t> largest_first(sizes.size());
    std::iota(largest_first.begin(), largest_first.end(), size_t(0));
    std::stable_sort(largest_first.begin(), largest_first.end(),
                     [&](size_t a, size_t b) { return sizes[a] > sizes[b]; });
    using Load = std::pair<uintmax_t, size_t>; // and whose, which decides ties
    std::vector<Load> loads;                   // a heap, the least on top
    for (size_t share = 1; share <= n; ++share) loads.push_back({0, share});
    std::vector<size_t> mine;
    for (const size_t place : largest_first) {
        std::pop_heap(loads.begin(), loads.end(), std::greater<>());
        // An empty file is some work, too.
        loads.back().first += std::max<uintmax_t>(sizes[place], 1);
        if (loads.back().second == i) mine.push_back(place);
        std::push_heap(loads.begin(), loads.end(), std::greater<>());
    }
    std::sort(mine.begin(), mine.end());
    return mine;
}

core::Result<ShareName> share_named(const std::string& text) {
    ShareName share{0, 0};
    const char* const end = text.data() + text.size();
    const auto [slash, wrong] = std::from_chars(text.data(), end, share.i);
    if (wrong == std::errc() && slash != end && *slash == '/') {
        const auto [last, also_wrong] = std::from_chars(slash + 1, end, share.n);
        if (also_wrong == std::errc() && last == end && share.i >= 1 && share.i <= share.n
            && share.n <= most_shares)
            return share;
    }
    return core::fail(core::ErrorCode::invalid_value,
                      fmt::format("'{}' is no share: write which of how many, as 2/8", text));
}

std::string json_of(const Shard& shard) {
    const auto text = [](const Json& json) {
        return json.dump(-1, ' ', false, Json::error_handler_t::replace);
    };
    std::string json = fmt::format(
        "{{\"feeler_shard\": 1, \"version\": {}, \"share\": [{}, {}], \"options\": {},\n"
        "\"places\": [{}],\n\"programs\": [",
        text(shard.version), shard.share.i, shard.share.n, text(shard.options),
        fmt::join(shard.places, ","));
    for (size_t i = 0; i < shard.programs.size(); ++i)
        json += (i == 0 ? "\n" : ",\n") + text(shard.programs[i]);
    json += "],\n\"results\": [";
    for (size_t i = 0; i < shard.results.size(); ++i)
        json += (i == 0 ? "\n" : ",\n") + json_of(shard.results[i]);
    return json + "]}\n";
}

core::Result<Shard> shard_from_json(const std::string& text) {
    Shard shard;
    try {
        const Json json = Json::parse(text);
        if (json.at("feeler_shard") != 1)
            return core::fail(core::ErrorCode::unsupported,
                              "was written by a newer version of Feeler");
        shard.version = json.at("version");
        shard.share = {json.at("share").at(0), json.at("share").at(1)};
        shard.options = json.at("options");
        shard.programs = json.at("programs").get<std::vector<std::string>>();
        shard.places = json.at("places").get<std::vector<size_t>>();
        for (const Json& each : json.at("results")) {
            FEELER_TRY(ProgramResult result, result_from_json(each.dump()));
            shard.results.push_back(std::move(result));
        }
    } catch (const std::exception& wrong) {
        return core::fail(core::ErrorCode::syntax,
                          fmt::format("is no share of a batch: {}", wrong.what()));
    }
    return shard;
}

core::Result<std::vector<ProgramResult>> merged(std::vector<Shard> shards) {
    if (shards.empty()) return core::fail(core::ErrorCode::missing_value, "there are no shares");
    std::sort(shards.begin(), shards.end(), [](const Shard& a, const Shard& b) {
        return a.share.i != b.share.i ? a.share.i < b.share.i : a.file < b.file;
    });
    if (auto whole = check_shares(shards); !whole) return tl::unexpected(whole.error());
    const std::vector<std::string>& programs = shards[0].programs;
    std::vector<const ProgramResult*> found(programs.size(), nullptr);
    for (const Shard& shard : shards) {
        for (size_t i = 0; i < std::max(shard.places.size(), shard.results.size()); ++i) {
            if (i >= shard.places.size() || i >= shard.results.size()
                || shard.places[i] >= programs.size()
                || shard.results[i].program != programs[shard.places[i]] || found[shard.places[i]])
                return tl::unexpected(
                    refusal(shard.file, "has a result that is not one of its programs'"));
            found[shard.places[i]] = &shard.results[i];
        }
    }
    std::vector<ProgramResult> results;
    for (size_t i = 0; i < programs.size(); ++i) {
        if (!found[i])
            return core::fail(core::ErrorCode::missing_value,
                              fmt::format("no share has a result of {}", programs[i]));
        results.push_back(*found[i]);
    }
    return results;
}

} // namespace app
