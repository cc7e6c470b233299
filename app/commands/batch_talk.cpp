#include "app/commands/batch_talk.h"

#include <cstdlib>

#include <unistd.h>

namespace app {

void BatchTalk::say(const std::string& text) const {
    std::fputs(text.c_str(), stream);
    std::fflush(stream);
}

BatchTalk talk_of(const BatchStyle& asked, const std::vector<ReportTarget>& targets) {
    BatchTalk talk{.style = asked};
    for (const ReportTarget& target : targets)
        if (target.path.empty() && target.format != "text") talk.stream = stderr;
    const char* no_colour = std::getenv("NO_COLOR");
    const bool may_colour = !no_colour || *no_colour == '\0';
    talk.style.colour = may_colour && ::isatty(::fileno(talk.stream)) == 1;
    return talk;
}

} // namespace app
