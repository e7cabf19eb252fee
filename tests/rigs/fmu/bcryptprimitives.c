/* Windows' own source of random bytes, for Wine before version 9, which has no such library: Rust's standard library asks it
   for the keys of its hash tables. */
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count) {
  return RtlGenRandom(bytes, (ULONG)count);
}
