#pragma once

namespace patchlight {

/// Has the heap of the main thread grow by pages of 2 MiB, where Linux gives them to those who ask, and keeps what is
/// freed: faults of small pages are half the time of a solve from cached rows. Call it first of all.
void use_large_pages();

}  // namespace patchlight
