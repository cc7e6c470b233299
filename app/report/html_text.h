#pragma once

#include <string>
#include <string_view>

namespace app {

/// A text of any bytes as it may stand in HTML, between tags and in quoted attributes: UTF-8, no
/// control characters, nothing that a browser would read as more than text.
std::string html_text(std::string_view text);

/// A string of JSON of any bytes, quotes included, that nothing ends early in a `script` element.
std::string script_string(std::string_view text);

/// Bytes by 64 characters, as data URIs have them.
std::string base64(std::string_view bytes);

} // namespace app
