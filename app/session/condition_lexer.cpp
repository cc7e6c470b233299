#include "app/session/condition_lexer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/session/value_text.h"
#include "core/sim/finding.h"

namespace app {
namespace {

using Kind = ConditionToken::Kind;

constexpr size_t longest = 4000; // of a text; nobody writes more by hand

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/// Longer signs stand before those that they begin with.
constexpr std::array<std::pair<std::string_view, std::string_view>, 24> signs = {{
    {"<=", "<="}, {">=", ">="}, {"==", "="},  {"!=", "!="}, {"<>", "!="}, {"&&", "and"},
    {"||", "or"}, {"<", "<"},   {">", ">"},   {"=", "="},   {"!", "not"}, {"(", "("},
    {")", ")"},   {"[", "["},   {"]", "]"},   {"+", "+"},   {"-", "-"},   {"*", "*"},
    {"/", "/"},   {"~", "~"},   {"&", "and"}, {"|", "or"},  {",", ","},   {";", ";"},
}};

/// Signs that are words.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> words = {{
    {"and", "and"},
    {"or", "or"},
    {"not", "not"},
    {"lt", "<"},
    {"le", "<="},
    {"gt", ">"},
    {"ge", ">="},
    {"eq", "="},
    {"ne", "!="},
}};

class Lexer {
public:
    explicit Lexer(std::string_view text) : text_(text) {}

    core::Result<std::vector<ConditionToken>> all() {
        std::vector<ConditionToken> tokens;
        if (text_.size() > longest)
            return core::fail(core::ErrorCode::syntax, "this is too long for a condition",
                              {.line = 1, .column = 1});
        do {
            while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
            FEELER_TRY(ConditionToken token, next());
            tokens.push_back(std::move(token));
        } while (tokens.back().kind != Kind::end);
        return tokens;
    }

private:
    char ahead(size_t by) const { return at_ + by < text_.size() ? text_[at_ + by] : '\0'; }

    ConditionToken token(Kind kind, size_t begin, std::string text = {}) const {
        return {.kind = kind, .text = std::move(text), .column = static_cast<uint32_t>(begin + 1)};
    }

    tl::unexpected<core::Error> refuse(size_t at, std::string why) const {
        return core::fail(core::ErrorCode::syntax, std::move(why),
                          {.line = 1, .column = static_cast<uint32_t>(at + 1), .length = 1});
    }

    core::Result<ConditionToken> next() {
        if (at_ >= text_.size()) return token(Kind::end, text_.size());
        const char c = text_[at_];
        if (is_digit(c) || (c == '.' && is_digit(ahead(1)))) return number();
        if (c == '"' || c == '\'') return quoted();
        if (c == '#') return parameter();
        if (is_letter(c) || c == '$') return name();
        for (const auto& [written, sign] : signs) {
            if (!text_.substr(at_).starts_with(written)) continue;
            at_ += written.size();
            return token(Kind::sign, at_ - written.size(), std::string(sign));
        }
        return refuse(at_, fmt::format("'{}' has no meaning here; a condition is written as "
                                       "clearance < 1 and rapid",
                                       c));
    }

    core::Result<ConditionToken> number() {
        const size_t begin = at_;
        double value = 0.0;
        const char* end = text_.data() + text_.size();
        const auto read =
            std::from_chars(text_.data() + begin, end, value, std::chars_format::fixed);
        at_ = static_cast<size_t>(read.ptr - text_.data());
        if (read.ec != std::errc() || !std::isfinite(value) || is_letter(ahead(0)))
            return refuse(begin,
                          fmt::format("'{}' is no number", text_.substr(begin, at_ + 1 - begin)));
        ConditionToken found = token(Kind::number, begin);
        found.number = value;
        return found;
    }

    core::Result<ConditionToken> quoted() {
        const size_t begin = at_;
        const size_t end = text_.find(text_[at_], at_ + 1);
        if (end == std::string_view::npos)
            return refuse(begin, "the quotation mark at the end is missing");
        at_ = end + 1;
        return token(Kind::text, begin, std::string(text_.substr(begin + 1, end - begin - 1)));
    }

    /// `#100`, `#<_name>`
    core::Result<ConditionToken> parameter() {
        const size_t begin = at_++;
        if (ahead(0) == '<') {
            const size_t end = text_.find('>', at_);
            if (end == std::string_view::npos || end == at_ + 1)
                return refuse(begin, "a named parameter is written as #<_name>");
            at_ = end + 1;
        } else {
            if (!is_digit(ahead(0)))
                return refuse(begin, "behind # belongs a number, as in #100, or a name, as in "
                                     "#<_name>");
            while (is_digit(ahead(0))) ++at_;
        }
        return token(Kind::name, begin, lowered(text_.substr(begin, at_ - begin)));
    }

    /// Also `machine.x`, `G59.1.x` and `$AA_IM[X]`.
    core::Result<ConditionToken> name() {
        const size_t begin = at_++;
        while (is_letter(ahead(0)) || is_digit(ahead(0))
               || (ahead(0) == '.' && (is_letter(ahead(1)) || is_digit(ahead(1)))))
            ++at_;
        if (text_[begin] == '$' && ahead(0) == '[') {
            const size_t end = text_.find(']', at_);
            if (end == std::string_view::npos) return refuse(at_, "the ']' is missing");
            at_ = end + 1;
        }
        std::string found = lowered(text_.substr(begin, at_ - begin));
        for (const auto& [word, sign] : words)
            if (word == found) return token(Kind::sign, begin, std::string(sign));
        std::string whole = rule_from(begin);
        if (core::default_severity(lowered(whole))) {
            at_ = begin + whole.size();
            found = lowered(whole);
        }
        ConditionToken name = token(Kind::name, begin, std::move(found));
        name.whole = std::move(whole);
        return name;
    }

    /// The longest rule that begins here, else the name with all that hyphens join to it.
    std::string rule_from(size_t begin) const {
        size_t end = at_, of_rule = 0;
        while (end + 1 < text_.size() && text_[end] == '-' && is_letter(text_[end + 1])) {
            for (++end; end < text_.size() && is_letter(text_[end]); ++end) continue;
            if (core::default_severity(lowered(text_.substr(begin, end - begin)))) of_rule = end;
        }
        return std::string(text_.substr(begin, (of_rule > 0 ? of_rule : end) - begin));
    }

    std::string_view text_;
    size_t at_ = 0;
};

} // namespace

core::Result<std::vector<ConditionToken>> tokens_of(std::string_view text) {
    return Lexer(text).all();
}

} // namespace app
