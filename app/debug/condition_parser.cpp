#include "app/debug/condition_parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/debug/inspected_value.h"
#include "core/base/text.h"
#include "core/sim/finding.h"
#include "gcode/language/lexer.h"

namespace app {
namespace {

using Kind = ConditionToken::Kind;

constexpr size_t longest = 4000; // characters of a condition; more is not written by hand

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/// Operators as written, and normalised. Longer ones come before their prefixes.
constexpr std::array<std::pair<std::string_view, std::string_view>, 24> signs = {{
    {"<=", "<="}, {">=", ">="}, {"==", "="},  {"!=", "!="}, {"<>", "!="}, {"&&", "and"},
    {"||", "or"}, {"<", "<"},   {">", ">"},   {"=", "="},   {"!", "not"}, {"(", "("},
    {")", ")"},   {"[", "["},   {"]", "]"},   {"+", "+"},   {"-", "-"},   {"*", "*"},
    {"/", "/"},   {"~", "~"},   {"&", "and"}, {"|", "or"},  {",", ","},   {";", ";"},
}};

/// Operators that are words.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> word_operators = {{
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
            return core::fail(core::ErrorCode::syntax, "the condition is too long",
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
        if (gcode::is_digit(c) || (c == '.' && gcode::is_digit(ahead(1)))) return number();
        if (c == '"' || c == '\'') return quoted();
        if (c == '#') return parameter();
        if (is_letter(c) || c == '$') return name();
        for (const auto& [written, sign] : signs) {
            if (!text_.substr(at_).starts_with(written)) continue;
            at_ += written.size();
            return token(Kind::sign, at_ - written.size(), std::string(sign));
        }
        return refuse(at_, fmt::format("'{}' is not allowed here; write a condition such as "
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
            return refuse(
                begin, fmt::format("'{}' is not a number", text_.substr(begin, at_ + 1 - begin)));
        ConditionToken found = token(Kind::number, begin);
        found.number = value;
        return found;
    }

    core::Result<ConditionToken> quoted() {
        const size_t begin = at_;
        const size_t end = text_.find(text_[at_], at_ + 1);
        if (end == std::string_view::npos)
            return refuse(begin, "the closing quotation mark is missing");
        at_ = end + 1;
        return token(Kind::text, begin, std::string(text_.substr(begin + 1, end - begin - 1)));
    }

    /// A parameter: `#100`, `#<_name>`.
    core::Result<ConditionToken> parameter() {
        const size_t begin = at_++;
        if (ahead(0) == '<') {
            const size_t end = text_.find('>', at_);
            if (end == std::string_view::npos || end == at_ + 1)
                return refuse(begin, "a named parameter is written as #<_name>");
            at_ = end + 1;
        } else {
            if (!gcode::is_digit(ahead(0)))
                return refuse(begin,
                              "# must be followed by a number, as in #100, or by a name, as in "
                              "#<_name>");
            while (gcode::is_digit(ahead(0))) ++at_;
        }
        return token(Kind::name, begin, core::lower_case(text_.substr(begin, at_ - begin)));
    }

    /// A name, also `machine.x`, `G59.1.x` and `$AA_IM[X]`.
    core::Result<ConditionToken> name() {
        const size_t begin = at_++;
        while (is_letter(ahead(0)) || gcode::is_digit(ahead(0))
               || (ahead(0) == '.' && (is_letter(ahead(1)) || gcode::is_digit(ahead(1)))))
            ++at_;
        if (text_[begin] == '$' && ahead(0) == '[') {
            const size_t end = text_.find(']', at_);
            if (end == std::string_view::npos) return refuse(at_, "the ']' is missing");
            at_ = end + 1;
        }
        std::string found = core::lower_case(text_.substr(begin, at_ - begin));
        for (const auto& [word, sign] : word_operators)
            if (word == found) return token(Kind::sign, begin, std::string(sign));
        std::string whole = rule_from(begin);
        if (core::default_severity(core::lower_case(whole))) {
            at_ = begin + whole.size();
            found = core::lower_case(whole);
        }
        ConditionToken name = token(Kind::name, begin, std::move(found));
        name.whole = std::move(whole);
        return name;
    }

    /// The longest name of a rule that begins here, else the name with all parts joined by hyphens.
    std::string rule_from(size_t begin) const {
        size_t end = at_, of_rule = 0;
        while (end + 1 < text_.size() && text_[end] == '-' && is_letter(text_[end + 1])) {
            for (++end; end < text_.size() && is_letter(text_[end]); ++end) continue;
            if (core::default_severity(core::lower_case(text_.substr(begin, end - begin))))
                of_rule = end;
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

namespace {

using Node = Condition::Node;

struct NamedFact {
    std::string_view name;
    BlockFact fact;
    ValueType type;
};

constexpr NamedFact facts[] = {
    {"clearance", BlockFact::clearance, ValueType::number},
    {"lower", BlockFact::clearance, ValueType::number},
    {"upper", BlockFact::upper, ValueType::number},
    {"allowance", BlockFact::allowance, ValueType::number},
    {"margin", BlockFact::margin, ValueType::number},
    {"removed", BlockFact::removed, ValueType::number},
    {"duration", BlockFact::duration, ValueType::number},
    {"time", BlockFact::time, ValueType::number},
    {"block", BlockFact::block, ValueType::number},
    {"line", BlockFact::line, ValueType::number},
    {"depth", BlockFact::depth, ValueType::number},
    {"tool", BlockFact::tool, ValueType::number},
    {"motion", BlockFact::motion, ValueType::word},
    {"verdict", BlockFact::verdict, ValueType::word},
    {"file", BlockFact::file, ValueType::word},
    {"rule", BlockFact::rule, ValueType::word},
};

// Findings that are off are not in the record.
constexpr std::array severities = {core::Severity::note, core::Severity::warning,
                                   core::Severity::error};

bool names_one_of(const auto& all, std::string_view name) {
    return core::find_named(all, name).has_value();
}

/// The number after a letter, as in t3; empty if the name has another form.
std::optional<double> number_after(char letter, const std::string& name) {
    int number = 0;
    if (name.size() < 2 || name[0] != letter) return std::nullopt;
    const char* end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + 1, end, number);
    if (read.ec != std::errc() || read.ptr != end || number < 0) return std::nullopt;
    return number;
}

/// Whether value_of returns a word for this name.
bool is_word_of_control(const std::string& name) {
    if (const ModalEntry* entry = modal_entry(name)) return entry->kind == ModalKind::word;
    return offset_named(core::upper_case(name)).has_value();
}

} // namespace

std::optional<Node> value_named(const std::string& name) {
    for (const NamedFact& fact : facts)
        if (fact.name == name)
            return Node{.kind = NodeKind::fact, .type = fact.type, .fact = fact.fact};
    if (const auto tool = number_after('t', name))
        return Node{.kind = NodeKind::number, .number = *tool};
    if (!names_value(name)) return std::nullopt;
    return Node{.kind = NodeKind::control,
                .type = is_word_of_control(name) ? ValueType::word : ValueType::number,
                .text = name};
}

std::optional<Node> truth_named(const std::string& name) {
    constexpr ValueType truth = ValueType::truth;
    if (names_one_of(core::all_block_motions, name))
        return Node{.kind = NodeKind::moves, .type = truth, .text = name};
    if (names_one_of(core::all_verdicts, name))
        return Node{.kind = NodeKind::judged, .type = truth, .text = name};
    if (names_one_of(severities, name))
        return Node{.kind = NodeKind::severity, .type = truth, .text = name};
    if (name == "near") return Node{.kind = NodeKind::near, .type = truth};
    if (name == "finding") return Node{.kind = NodeKind::severity, .type = truth};
    if (core::default_severity(name))
        return Node{.kind = NodeKind::rule, .type = truth, .text = name};
    if (const auto tool = number_after('t', name))
        return Node{.kind = NodeKind::has_tool, .type = truth, .number = *tool};
    if (number_after('n', name))
        return Node{.kind = NodeKind::numbered, .type = truth, .text = name};
    return std::nullopt;
}

namespace {

std::vector<std::string> named_words(const auto& all) {
    const std::vector<std::string_view> names = core::names_of(all);
    return {names.begin(), names.end()};
}

} // namespace

std::vector<std::string> words_for(const Node& node) {
    if (node.kind == NodeKind::fact && node.fact == BlockFact::motion)
        return named_words(core::all_block_motions);
    if (node.kind == NodeKind::fact && node.fact == BlockFact::verdict)
        return named_words(core::all_verdicts);
    if (node.kind == NodeKind::fact && node.fact == BlockFact::rule) return core::rule_names();
    const ModalEntry* entry = node.kind == NodeKind::control ? modal_entry(node.text) : nullptr;
    return entry ? words_of(*entry) : std::vector<std::string>{};
}

std::vector<std::string> condition_names() {
    std::vector<std::string> names;
    for (const NamedFact& fact : facts) names.emplace_back(fact.name);
    const auto add = [&](const auto& all) {
        for (const std::string_view name : core::names_of(all)) names.emplace_back(name);
    };
    add(core::all_block_motions);
    add(core::all_verdicts);
    add(severities);
    names.emplace_back("finding");
    names.emplace_back("near");
    for (std::string& rule : core::rule_names()) names.push_back(std::move(rule));
    for (std::string& name : names_beginning("")) names.push_back(std::move(name));
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

std::vector<std::string> condition_names_beginning(const std::string& text) {
    const std::string start = core::lower_case(text);
    std::vector<std::string> names;
    for (std::string& name : condition_names())
        if (core::lower_case(name).starts_with(start)) names.push_back(std::move(name));
    return names;
}

namespace {

constexpr int deepest = 100; // nested brackets and signs

const char* name_of(ValueType type) {
    switch (type) {
    case ValueType::number:
        return "a number";
    case ValueType::word:
        return "a word";
    default:
        return "true or false";
    }
}

Node joined(NodeKind kind, ValueType type, Node left, Node right) {
    const uint32_t column = left.column;
    Node node{.kind = kind, .type = type, .column = column};
    node.of.push_back(std::move(left));
    node.of.push_back(std::move(right));
    return node;
}

Node made_of(NodeKind kind, ValueType type, Node one, uint32_t column) {
    Node node{.kind = kind, .type = type, .column = column};
    node.of.push_back(std::move(one));
    return node;
}

/// Recursive descent: or, and, not, comparisons, sums, products, single values.
class Parser {
public:
    explicit Parser(std::vector<ConditionToken> tokens) : tokens_(std::move(tokens)) {}

    core::Result<Node> whole() {
        if (now().kind == Kind::end)
            return refuse(now(),
                          "there is no condition; write one such as clearance < 1 and rapid");
        FEELER_TRY(Node node, either());
        if (now().kind == Kind::end) return node;
        if (is_sign(")") || is_sign("]")) return refuse(now(), "this bracket was never opened");
        return refuse(now(), "'and' or 'or' is missing here, or a comparison");
    }

private:
    const ConditionToken& now() const { return tokens_[at_]; }
    bool is_sign(std::string_view sign) const {
        return now().kind == Kind::sign && now().text == sign;
    }
    bool take(std::string_view sign) {
        if (!is_sign(sign)) return false;
        ++at_;
        return true;
    }

    static tl::unexpected<core::Error> refuse(uint32_t column, std::string why) {
        return core::fail(core::ErrorCode::syntax, std::move(why), {.line = 1, .column = column});
    }
    static tl::unexpected<core::Error> refuse(const ConditionToken& token, std::string why) {
        return refuse(token.column, std::move(why));
    }

    static core::Result<void> want_truth(const Node& node) {
        if (node.type == ValueType::truth) return {};
        return refuse(node.column,
                      fmt::format("this is {}, not a condition: compare it, as in {}",
                                  name_of(node.type),
                                  node.type == ValueType::word ? "plane = ZX" : "clearance < 1"));
    }
    static core::Result<void> want_number(const Node& node) {
        if (node.type == ValueType::number) return {};
        return refuse(node.column,
                      node.type == ValueType::word
                          ? "words can only be compared with = and !="
                          : "this is true or false, not a number: combine it with 'and' or 'or'");
    }

    core::Result<Node> either() {
        FEELER_TRY(Node left, both());
        while (take("or")) {
            FEELER_TRY(Node right, both());
            FEELER_TRY(left, join(NodeKind::either, std::move(left), std::move(right)));
        }
        return left;
    }

    core::Result<Node> both() {
        FEELER_TRY(Node left, opposite());
        while (take("and")) {
            FEELER_TRY(Node right, opposite());
            FEELER_TRY(left, join(NodeKind::both, std::move(left), std::move(right)));
        }
        return left;
    }

    static core::Result<Node> join(NodeKind kind, Node left, Node right) {
        for (const Node* node : {&left, &right})
            if (auto wanted = want_truth(*node); !wanted) return tl::unexpected(wanted.error());
        return joined(kind, ValueType::truth, std::move(left), std::move(right));
    }

    core::Result<Node> opposite() {
        const uint32_t column = now().column;
        if (!take("not")) return comparison();
        if (++depth_ > deepest) return refuse(column, "the condition is nested too deeply");
        FEELER_TRY(Node node, opposite());
        --depth_;
        if (auto wanted = want_truth(node); !wanted) return tl::unexpected(wanted.error());
        return made_of(NodeKind::opposite, ValueType::truth, std::move(node), column);
    }

    bool is_comparison(const ConditionToken& token) const {
        return token.kind == Kind::sign
               && (token.text == "<" || token.text == "<=" || token.text == ">"
                   || token.text == ">=" || token.text == "=" || token.text == "!=");
    }

    /// A comparison, also a chain: 0 < z < 5 is 0 < z and z < 5.
    core::Result<Node> comparison() {
        is_compared_ = in_sum_ || is_compared_ahead();
        FEELER_TRY(Node left, sum());
        if (!is_comparison(now())) return left;
        std::optional<Node> all;
        while (is_comparison(now())) {
            const std::string sign = now().text;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, left.type == ValueType::word ? word_for(left) : sum());
            FEELER_TRY(Node one, compared(sign, left, right));
            if (all)
                all = joined(NodeKind::both, ValueType::truth, *std::move(all), std::move(one));
            else
                all = std::move(one);
            left = std::move(right);
        }
        return *std::move(all);
    }

    /// Whether the value that begins here is an operand of a comparison or calculation, so that
    /// `feed` is a number.
    bool is_compared_ahead() const {
        size_t at = at_;
        while (tokens_[at].kind == Kind::sign && tokens_[at].text == "-") ++at;
        if (tokens_[at].kind != Kind::name) return false;
        const ConditionToken& after = tokens_[at + 1];
        return is_comparison(after)
               || (after.kind == Kind::sign && std::string_view("+-*/").find(after.text) < 4);
    }

    /// A comparison with `rule`. A block may have findings of several rules.
    static Node compared_rule(const std::string& sign, const Node& left, const Node& right) {
        Node rule{.kind = NodeKind::rule,
                  .type = ValueType::truth,
                  .text = right.text,
                  .column = left.column};
        if (sign == "=") return rule;
        return made_of(NodeKind::opposite, ValueType::truth, std::move(rule), left.column);
    }

    static core::Result<Node> compared(const std::string& sign, Node left, Node right) {
        const bool words = left.type == ValueType::word && right.type == ValueType::word;
        if (!words || (sign != "=" && sign != "!="))
            for (const Node* node : {&left, &right})
                if (auto wanted = want_number(*node); !wanted)
                    return tl::unexpected(wanted.error());
        if (left.kind == NodeKind::fact && left.fact == BlockFact::rule && words)
            return compared_rule(sign, left, right);
        const bool turned = sign[0] == '>';
        const NodeKind kind = sign == "="        ? NodeKind::equal
                              : sign == "!="     ? NodeKind::not_equal
                              : sign.size() == 2 ? NodeKind::less_or_equal
                                                 : NodeKind::less;
        if (turned) std::swap(left, right);
        return joined(kind, ValueType::truth, std::move(left), std::move(right));
    }

    /// The right side of a comparison with a word: a quoted text, or a name taken literally.
    core::Result<Node> word_for(const Node& left) {
        const ConditionToken token = now();
        if (token.kind != Kind::text && token.kind != Kind::name && token.kind != Kind::number)
            return refuse(token, "a word or a quoted text is missing here");
        ++at_;
        const std::string text =
            token.kind == Kind::number ? number_text(token.number) : token.text;
        const std::vector<std::string> words = words_for(left);
        const bool is_one =
            words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
                return core::lower_case(word) == core::lower_case(text);
            });
        if (!is_one)
            return refuse(token, fmt::format("this cannot be '{}'; it may be {}", text,
                                             fmt::join(words, ", ")));
        return Node{.kind = NodeKind::word,
                    .type = ValueType::word,
                    .text = core::lower_case(text),
                    .column = token.column};
    }

    core::Result<Node> sum() {
        FEELER_TRY(Node left, product());
        while (is_sign("+") || is_sign("-")) {
            const NodeKind kind = is_sign("+") ? NodeKind::add : NodeKind::subtract;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, product());
            FEELER_TRY(left, counted(kind, std::move(left), std::move(right)));
        }
        return left;
    }

    core::Result<Node> product() {
        FEELER_TRY(Node left, signed_value());
        while (is_sign("*") || is_sign("/")) {
            const NodeKind kind = is_sign("*") ? NodeKind::multiply : NodeKind::divide;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, signed_value());
            FEELER_TRY(left, counted(kind, std::move(left), std::move(right)));
        }
        return left;
    }

    static core::Result<Node> counted(NodeKind kind, Node left, Node right) {
        for (const Node* node : {&left, &right})
            if (auto wanted = want_number(*node); !wanted) return tl::unexpected(wanted.error());
        return joined(kind, ValueType::number, std::move(left), std::move(right));
    }

    core::Result<Node> signed_value() {
        const uint32_t column = now().column;
        if (take("+")) return signed_value_within(column);
        if (!take("-")) return single();
        is_compared_ = true;
        FEELER_TRY(Node node, signed_value_within(column));
        if (auto wanted = want_number(node); !wanted) return tl::unexpected(wanted.error());
        return made_of(NodeKind::negate, ValueType::number, std::move(node), column);
    }

    core::Result<Node> signed_value_within(uint32_t column) {
        if (++depth_ > deepest) return refuse(column, "the condition is nested too deeply");
        FEELER_TRY(Node node, signed_value());
        --depth_;
        return node;
    }

    core::Result<Node> single() {
        const ConditionToken token = now();
        if (token.kind == Kind::sign && (token.text == "(" || token.text == "[")) return bracket();
        if (take("~")) return text_of_line(token.column);
        if (token.kind == Kind::end)
            return refuse(token, "the condition ends too early: a value is missing");
        if (token.kind == Kind::sign)
            return refuse(token, fmt::format("a value is missing before '{}'", token.text));
        ++at_;
        if (token.kind == Kind::number)
            return Node{.kind = NodeKind::number, .number = token.number, .column = token.column};
        if (token.kind == Kind::text)
            return Node{.kind = NodeKind::body,
                        .type = ValueType::truth,
                        .text = core::lower_case(token.text),
                        .column = token.column};
        return named(token);
    }

    core::Result<Node> bracket() {
        const ConditionToken open = now();
        ++at_;
        if (++depth_ > deepest) return refuse(open, "the condition is nested too deeply");
        const bool outer = std::exchange(in_sum_, is_compared_);
        FEELER_TRY(Node node, either());
        is_compared_ = std::exchange(in_sum_, outer);
        --depth_;
        const std::string_view closing = open.text == "(" ? ")" : "]";
        if (!take(closing))
            return refuse(now(), fmt::format("the '{}' of the bracket in column {} is missing here",
                                             closing, open.column));
        return node;
    }

    core::Result<Node> text_of_line(uint32_t column) {
        const ConditionToken token = now();
        if (token.kind != Kind::text && token.kind != Kind::name)
            return refuse(token, "~ must be followed by a text, as in ~ \"G81\"");
        ++at_;
        return Node{.kind = NodeKind::contains,
                    .type = ValueType::truth,
                    .text = core::lower_case(token.text),
                    .column = column};
    }

    core::Result<Node> named(const ConditionToken& token) const {
        std::optional<Node> truth = truth_named(token.text), value = value_named(token.text);
        const bool as_value = value && (is_compared_ || is_comparison(now()) || !truth);
        // Nothing can be subtracted from true or false, so near-mis is a misspelt name.
        const bool has_tail =
            !as_value && !token.whole.empty() && core::lower_case(token.whole) != token.text;
        if (has_tail) return unknown(token);
        std::optional<Node> node = as_value ? std::move(value) : std::move(truth);
        if (!node) return unknown(token);
        node->column = token.column;
        return *std::move(node);
    }

    static tl::unexpected<core::Error> unknown(const ConditionToken& token) {
        const std::string written = token.whole.empty() ? token.text : token.whole;
        return refuse(
            token, fmt::format("'{}' is not a known name; the nearest name is '{}'", written,
                               core::nearest_name(core::lower_case(written), condition_names())));
    }

    std::vector<ConditionToken> tokens_;
    size_t at_ = 0;
    int depth_ = 0;
    bool is_compared_ = false; // names mean numbers if possible
    bool in_sum_ = false;      // the same for a whole bracket
};

} // namespace

core::Result<Node> parse_condition(std::string_view text) {
    FEELER_TRY(std::vector<ConditionToken> tokens, tokens_of(text));
    return Parser(std::move(tokens)).whole();
}

} // namespace app
