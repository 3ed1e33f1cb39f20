#include "tools/page_template.h"

#ifdef PRCAGE_REPORT_PAGE

// By the assembler, because a compiler takes long over a megabyte of literal.
__asm__(
    ".section .rodata\n"
    ".global prcage_report_page\n"
    ".global prcage_report_page_end\n"
    "prcage_report_page:\n"
    ".incbin \"" PRCAGE_REPORT_PAGE
    "\"\n"
    "prcage_report_page_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" {
extern const char prcage_report_page[];
extern const char prcage_report_page_end[];
}

namespace prcage {

PageTemplate page_template() {
  constexpr std::string_view place_of_data = "<!--data-->";
  const std::string_view page(prcage_report_page,
                              static_cast<std::size_t>(prcage_report_page_end - prcage_report_page));
  const std::size_t place = page.find(place_of_data);
  return {page.substr(0, place), page.substr(place + place_of_data.size())};
}

}  // namespace prcage

#else

namespace prcage {

PageTemplate page_template() { return {}; }

}  // namespace prcage

#endif
