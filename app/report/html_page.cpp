#include "app/report/html_page.h"

namespace app {

std::string filled_page(std::string_view page, const PageFillings& fillings) {
    std::string text;
    while (true) {
        const size_t open = page.find("{{");
        if (open == page.npos) return text += page;
        const size_t close = page.find("}}", open);
        text += page.substr(0, open);
        text += fillings.at(std::string(page.substr(open + 2, close - open - 2)));
        page = page.substr(close + 2);
    }
}

} // namespace app
