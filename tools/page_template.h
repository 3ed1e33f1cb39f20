// The page of `prcage report` without its data: tools/report_page bundles it, the build embeds it into the program.
#pragma once

#include <string_view>

namespace prcage {

// The two parts between which the data belong. Both empty if the program was built without the page.
struct PageTemplate {
  std::string_view head;
  std::string_view tail;

  bool empty() const { return head.empty(); }
};

PageTemplate page_template();

}  // namespace prcage
