#include "app/view/model/typed_number.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "core/base/units.h"

namespace app::viewer {
namespace {

constexpr double most = 1e6;

/// A value and whether a unit was written with it; a length then is in mm.
struct TypedValue {
    double number = 0.0;
    bool has_unit = false;
};

/// Reads an expression. Grammar:
///
///     sum     = product {("+" | "-") product}
///     product = signed {("*" | "/") signed}
///     signed  = {"+" | "-"} value
///     value   = "(" sum ")" | number [number "/" number] [unit]
///
/// After the first mistake `why` is set, and what follows does not matter.
class TypedReader {
public:
    explicit TypedReader(std::string_view text) : rest_(text) {}

    core::Result<TypedValue> read() {
        const TypedValue value = sum();
        skip_blanks();
        if (why_.empty() && !rest_.empty()) refuse(fmt::format("\"{}\" is not understood", rest_));
        if (why_.empty() && !std::isfinite(value.number)) refuse("it is divided by zero");
        if (why_.empty() && std::abs(value.number) > most) refuse("it is too large");
        if (why_.empty()) return value;
        return core::fail(core::ErrorCode::invalid_value, why_);
    }

private:
    void refuse(std::string why) {
        if (why_.empty()) why_ = std::move(why);
        rest_ = {};
    }

    void skip_blanks() {
        while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t'))
            rest_.remove_prefix(1);
    }

    bool take(std::string_view token) {
        skip_blanks();
        if (!rest_.starts_with(token)) return false;
        rest_.remove_prefix(token.size());
        return true;
    }

    TypedValue sum() {
        TypedValue value = product();
        while (why_.empty()) {
            const bool adds = take("+");
            if (!adds && !take("-")) break;
            const TypedValue other = product();
            if (other.has_unit != value.has_unit)
                refuse("write the unit with both numbers or with none");
            value.number += adds ? other.number : -other.number;
        }
        return value;
    }

    TypedValue product() {
        TypedValue value = signed_value();
        while (why_.empty()) {
            const bool multiplies = take("*");
            if (!multiplies && !take("/")) break;
            const TypedValue other = signed_value();
            if (other.has_unit && (value.has_unit || !multiplies))
                refuse("this product is not a length");
            value.number = multiplies ? value.number * other.number : value.number / other.number;
            value.has_unit = value.has_unit || other.has_unit;
        }
        return value;
    }

    TypedValue signed_value() {
        bool is_negative = false;
        while (true) {
            if (take("-") || take("\xE2\x88\x92")) // the minus sign of typography
                is_negative = !is_negative;
            else if (!take("+"))
                break;
        }
        TypedValue value = this->value();
        if (is_negative) value.number = -value.number;
        return value;
    }

    TypedValue value() {
        if (take("(")) {
            const TypedValue inner = sum();
            if (!take(")")) refuse("a parenthesis is not closed");
            return inner;
        }
        TypedValue value{number(), false};
        if (const auto part = fraction_behind()) value.number += *part;
        take_unit(value);
        if (!value.has_unit) take_fraction_with_unit(value);
        return value;
    }

    /// The "1/2" of "2 1/2".
    std::optional<double> fraction_behind() {
        if (!rest_.starts_with(' ')) return {};
        const std::string_view before = rest_;
        skip_blanks();
        const size_t digits = rest_.find_first_not_of("0123456789");
        const bool is_fraction =
            digits != 0 && digits != std::string_view::npos && rest_[digits] == '/';
        if (!is_fraction) {
            rest_ = before;
            return {};
        }
        const double above = number();
        take("/");
        return above / number();
    }

    /// The "/2 in" of "1/2 in".
    void take_fraction_with_unit(TypedValue& value) {
        const std::string_view before = rest_;
        if (!take("/") || rest_.empty() || rest_.front() < '0' || rest_.front() > '9') {
            rest_ = before;
            return;
        }
        TypedValue below{1.0 / number(), false};
        take_unit(below);
        if (below.has_unit)
            value = {value.number * below.number, true};
        else
            rest_ = before;
    }

    void take_unit(TypedValue& value) {
        const double unit = take("mm")                                 ? 1.0
                            : take("inch") || take("in") || take("\"") ? core::mm_per_inch
                                                                       : 0.0;
        if (unit == 0.0) return;
        value.number *= unit;
        value.has_unit = true;
    }

    /// A number without a sign, with a point or a comma.
    double number() {
        skip_blanks();
        const size_t end = rest_.find_first_not_of("0123456789.,");
        std::string word(rest_.substr(0, end));
        rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end);
        if (word.empty()) {
            refuse(rest_.empty() ? "a number is missing"
                                 : fmt::format("\"{}\" is not a number", rest_));
            return 0.0;
        }
        if (const size_t comma = word.find(','); comma != std::string::npos) {
            const size_t behind = word.size() - comma - 1;
            const bool may_mean_thousands = behind == 3 && comma <= 3 && word[0] != '0';
            if (may_mean_thousands)
                refuse(fmt::format("{} can mean {}.{} or {}{}", word, word.substr(0, comma),
                                   word.substr(comma + 1), word.substr(0, comma),
                                   word.substr(comma + 1)));
            word[comma] = '.';
        }
        double number = 0.0;
        const char* const last = word.data() + word.size();
        const auto [stopped, error] =
            std::from_chars(word.data(), last, number, std::chars_format::fixed);
        if (error != std::errc() || stopped != last)
            refuse(fmt::format("\"{}\" is not a number", word));
        return number;
    }

    std::string_view rest_;
    std::string why_;
};

core::Error not_understood(const std::string& text, const core::Error& why) {
    return {why.code, {}, fmt::format("\"{}\": {}", text, why.message)};
}

} // namespace

core::Result<double> typed_number(const std::string& text) {
    auto value = TypedReader(text).read();
    if (value && value->has_unit)
        value = core::fail(core::ErrorCode::invalid_value, "a number without a unit is wanted");
    if (!value) return tl::unexpected(not_understood(text, value.error()));
    return value->number;
}

core::Result<double> typed_length(const std::string& text, bool is_inch) {
    const auto value = TypedReader(text).read();
    if (!value) return tl::unexpected(not_understood(text, value.error()));
    return value->has_unit || !is_inch ? value->number : value->number * core::mm_per_inch;
}

std::string field_text(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.find('.') == std::string::npos) return text;
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text == "-0" ? "0" : text;
}

} // namespace app::viewer
