#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace core {

/// A range in the user's text. Lines and columns count from 1. Line 0: not in a file; column 0: the
/// whole line.
struct SourceSpan {
    uint32_t line = 0;
    uint32_t column = 0;
    uint32_t length = 0;

    bool operator==(const SourceSpan&) const = default;
};

enum class ErrorCode : uint8_t { io, syntax, unsupported, invalid_value, missing_value };

/// A mistake in the user's input. Mistakes in our own code are asserts, not Errors.
struct Error {
    ErrorCode code;
    SourceSpan where;
    std::string message; // one sentence that names the word or file at fault; no trailing newline
    std::string file{};  // path as the user gave it; set by the caller that knows it

    bool operator==(const Error&) const = default;
};

template <typename T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message, SourceSpan where = {}) {
    return tl::unexpected<Error>(Error{code, where, std::move(message)});
}

/// An invalid value: a file that cannot be what the user wants. `message` follows its path.
inline tl::unexpected<Error> fail_file(const std::string& path, std::string message) {
    return tl::unexpected<Error>(Error{ErrorCode::invalid_value, {}, std::move(message), path});
}

/// The error, with the path of its file if it has none.
inline Error in_file(Error error, const std::string& path) {
    if (error.file.empty()) error.file = path;
    return error;
}

} // namespace core

#define FEELER_CONCAT_(a, b) a##b
#define FEELER_CONCAT(a, b) FEELER_CONCAT_(a, b)

/// FEELER_TRY(auto block, parse_block(line)); declares `block`, or returns the error from the
/// enclosing function.
#define FEELER_TRY(declaration, expression)                                                        \
    auto FEELER_CONCAT(feeler_try_, __LINE__) = (expression);                                      \
    if (!FEELER_CONCAT(feeler_try_, __LINE__))                                                     \
        return tl::unexpected(std::move(FEELER_CONCAT(feeler_try_, __LINE__)).error());            \
    declaration = *std::move(FEELER_CONCAT(feeler_try_, __LINE__))
