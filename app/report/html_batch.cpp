#include "app/report/html_batch.h"

#include "app/report/html_assets.h"
#include "app/report/html_batch_columns.h"
#include "app/report/html_batch_facts.h"
#include "app/report/html_page.h"
#include "app/report/html_palette.h"
#include "app/report/html_text.h"
#include "app/version.h"

namespace app {

std::string batch_html_report(const BatchResult& batch) {
    const PageAssets assets = batch_page_assets();
    return filled_page(assets.page, {{"version", version},
                                     {"name", html_text(batch_title(batch))},
                                     {"outcome", batch_outcome_text(batch)},
                                     {"verdict", batch_outcome_class(batch)},
                                     {"palette", html_palette()},
                                     {"style", std::string(assets.style)},
                                     {"missing", html_missing(batch)},
                                     {"outcomes", html_outcomes(batch)},
                                     {"summary", html_batch_summary(batch)},
                                     {"rules", html_rules(batch)},
                                     {"skipped", html_skipped(batch)},
                                     {"programs", batch_columns_json(batch)},
                                     {"script", std::string(assets.script)}});
}

} // namespace app
