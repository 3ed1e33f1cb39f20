// The planes of stars for one instruction set, PRCAGE_ARCH as xsimd names it. For the sources named
// star_planes_<instruction set>.cpp only.
#pragma once

#include "core/star_planes_kernel.h"
#include "core/vector_access_xsimd.h"
