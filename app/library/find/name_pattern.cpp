#include "app/library/find/name_pattern.h"

#include <optional>
#include <string>
#include <string_view>

#include "app/base/text.h"
#include "core/base/platform.h"

namespace app {
namespace {

bool is_in_class(std::u32string_view name, char32_t c) {
    const auto is_within = [c](char32_t first, char32_t last) { return first <= c && c <= last; };
    const bool upper = is_within('A', 'Z'), lower = is_within('a', 'z'),
               digit = is_within('0', '9');
    const bool blank = c == ' ' || c == '\t';
    if (name == U"alpha") return upper || lower;
    if (name == U"alnum") return upper || lower || digit;
    if (name == U"digit") return digit;
    if (name == U"xdigit") return digit || is_within('A', 'F') || is_within('a', 'f');
    if (name == U"upper") return upper;
    if (name == U"lower") return lower;
    if (name == U"blank") return blank;
    if (name == U"space") return blank || is_within('\n', '\r');
    return name == U"punct" && is_within('!', '~') && !upper && !lower && !digit;
}

/// Whether a character is in the set whose `[` is before `at`; moves behind its `]`. Empty, and
/// `at` stays, if there is no `]`.
std::optional<bool> is_in_set(std::u32string_view pattern, size_t& at, char32_t c) {
    const bool is_negated = at < pattern.size() && (pattern[at] == U'!' || pattern[at] == U'^');
    const size_t first = at + (is_negated ? 1 : 0);
    bool is_in = false;
    for (size_t i = first; i < pattern.size(); ++i) {
        if (pattern[i] == U']' && i != first) {
            at = i + 1;
            return is_in != is_negated;
        }
        const size_t end = pattern.find(U":]", i + 2);
        if (pattern.substr(i, 2) == U"[:" && end != std::u32string_view::npos) {
            is_in = is_in || is_in_class(pattern.substr(i + 2, end - i - 2), c);
            i = end + 1;
            continue;
        }
        if (pattern[i] == U'\\' && i + 1 < pattern.size()) ++i;
        const bool is_range =
            i + 2 < pattern.size() && pattern[i + 1] == U'-' && pattern[i + 2] != U']';
        is_in = is_in || (is_range ? pattern[i] <= c && c <= pattern[i + 2] : pattern[i] == c);
        if (is_range) i += 2;
    }
    return std::nullopt;
}

/// Whether what is at `at` of the pattern, not a `*`, takes a character; moves behind it.
bool takes(std::u32string_view pattern, size_t& at, char32_t c) {
    char32_t wanted = pattern[at++];
    if (wanted == U'?') return true;
    if (wanted == U'[')
        if (const auto is_in = is_in_set(pattern, at, c)) return *is_in;
    if (wanted == U'\\' && at < pattern.size()) wanted = pattern[at++];
    return wanted == c;
}

bool matches(std::u32string_view pattern, std::u32string_view name) {
    size_t at = 0, i = 0, tried = 0;
    std::optional<size_t> after_star; // the last one; it takes what is before `tried`
    while (i < name.size()) {
        if (at < pattern.size() && pattern[at] == U'*') {
            after_star = ++at;
            tried = i;
            continue;
        }
        if (size_t next = at; at < pattern.size() && takes(pattern, next, name[i])) {
            at = next;
            ++i;
        } else if (after_star) {
            at = *after_star;
            i = ++tried;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of(U'*', at) == std::u32string_view::npos;
}

} // namespace

bool matches_pattern(const std::string& pattern, const std::string& name) {
    const bool has_dot = pattern.starts_with('.') || pattern.starts_with("\\.");
    if (name.starts_with('.') && !has_dot) return false;
    return matches(code_points(core::platform::case_folded(pattern)),
                   code_points(core::platform::case_folded(name)));
}

} // namespace app
