/* hypot as glibc has had it from its beginning: all else in a wheel runs with glibc 2.34, but the new version of this function
   with 2.35 or later only. scripts/wheel.sh links it. */
#ifdef __aarch64__
#define FIRST "GLIBC_2.17"
#else
#define FIRST "GLIBC_2.2.5"
#endif
double firstHypot(double x, double y);
float firstHypotf(float x, float y);
__asm__(".symver firstHypot, hypot@" FIRST);
__asm__(".symver firstHypotf, hypotf@" FIRST);

#pragma GCC visibility push(hidden)
double hypot(double x, double y) { return firstHypot(x, y); }
float hypotf(float x, float y) { return firstHypotf(x, y); }
