// Which kerf this is. Macros alone, for C as well.
#pragma once

#define KERF_VERSION_MAJOR 0  ///< changes when the interface breaks, from 1 on
#define KERF_VERSION_MINOR 1  ///< before 1.0 it may, too
#define KERF_VERSION_PATCH 0  ///< corrections alone

/// One number to compare with: 102 is 0.1.2, 10203 is 1.2.3.
#define KERF_VERSION_NUMBER (KERF_VERSION_MAJOR * 10000 + KERF_VERSION_MINOR * 100 + KERF_VERSION_PATCH)

#define KERF_VERSION_TEXT_OF(major, minor, patch) #major "." #minor "." #patch
#define KERF_VERSION_TEXT(major, minor, patch) KERF_VERSION_TEXT_OF(major, minor, patch)

/// The same to show, as "0.1.2".
#define KERF_VERSION KERF_VERSION_TEXT(KERF_VERSION_MAJOR, KERF_VERSION_MINOR, KERF_VERSION_PATCH)
