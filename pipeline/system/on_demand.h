#pragma once

namespace patchlight {

/// The function `symbol` of a module of ours in ../lib/patchlight beside the program, loaded the first time that it is
/// asked for. For what takes longer to load than most runs take to work, and few of them need: OpenImageIO stands on
/// 250 libraries, a tenth of a second. Throws: Error (internal) if the module cannot be loaded.
void* on_demand(const char* module, const char* symbol);

/// The same with the type of the function.
template <class Function>
Function* on_demand(const char* module, const char* symbol) {
  return reinterpret_cast<Function*>(on_demand(module, symbol));
}

}  // namespace patchlight
