/* A firmware for an STM32F405 without a system: the reference client as a device on USART1.
 *
 * Start-up, vectors, the driver of the USART and the clock are here, by registers; the protocol is
 * fixtures/wire/clients/octant_client.c as it is. It echoes, as `octant_client device` does. Clocks are
 * those of a board that has started its PLL, and of QEMU's netduinoplus2: the core at 168 MHz, USART1
 * at 84 MHz.
 */
/* Answers that a run accepts. */
#define OCTANT_UNIT
#define OCTANT_NO_MAIN
#define OCTANT_FIRMWARE "echo 1, STM32F405"
/* The line is two processes of a host that may have other work. */
#define OCTANT_SILENCE_MS 60000
#include "../../../fixtures/wire/clients/octant_client.c"

#define CORE_HZ 168000000u
#define USART1_CLOCK_HZ 84000000u
#define BAUD 115200u

#define REGISTER(address) (*(volatile uint32_t *)(address))
/* Clocks of the peripherals. */
#define RCC_AHB1ENR REGISTER(0x40023830)
#define RCC_APB2ENR REGISTER(0x40023844)
/* Pins: PA9 is TX and PA10 RX of USART1, as alternate function 7. */
#define GPIOA_MODER REGISTER(0x40020000)
#define GPIOA_AFRH REGISTER(0x40020024)
/* USART1. */
#define USART_SR REGISTER(0x40011000)
#define USART_DR REGISTER(0x40011004)
#define USART_BRR REGISTER(0x40011008)
#define USART_CR1 REGISTER(0x4001100C)
#define SR_RXNE (1u << 5)
#define SR_TXE (1u << 7)
#define CR1_RE (1u << 2)
#define CR1_TE (1u << 3)
#define CR1_RXNEIE (1u << 5)
#define CR1_UE (1u << 13)
/* The processor's own. */
#define SYST_CSR REGISTER(0xE000E010)
#define SYST_RVR REGISTER(0xE000E014)
#define SYST_CVR REGISTER(0xE000E018)
#define ICSR REGISTER(0xE000ED04)
#define ICSR_PENDSTSET (1u << 26)
#define NVIC_ISER1 REGISTER(0xE000E104)
#define USART1_IRQ 37

/* --- Clock ------------------------------------------------------------------------------------ */

static volatile uint32_t milliseconds;

void SysTick_Handler(void) { milliseconds++; }

/* Since the start. Its milliseconds are 32 bits: it runs for 49 days. */
static uint64_t now_ns(void) {
  uint32_t before, ticks, pending;
  do {
    before = milliseconds;
    ticks = CORE_HZ / 1000 - 1 - SYST_CVR;
    pending = ICSR & ICSR_PENDSTSET;
  } while (before != milliseconds || pending);
  return UINT64_C(1000000) * before + UINT64_C(1000) * ticks / (CORE_HZ / 1000000);
}

/* --- USART1 ----------------------------------------------------------------------------------- */

/* What came and wasn't looked at. What finds no room is lost, and the checksum of its frame tells. */
static volatile uint8_t ring[8192];
static volatile uint32_t ring_in, ring_out;

void USART1_Handler(void) {
  while (USART_SR & SR_RXNE) {
    uint8_t byte = (uint8_t)USART_DR;
    if (ring_in - ring_out < sizeof ring) {
      ring[ring_in % sizeof ring] = byte;
      ring_in++;
    }
  }
}

static void send(const uint8_t *data, size_t length) {
  for (size_t i = 0; i < length; i++) {
    while (!(USART_SR & SR_TXE)) {}
    USART_DR = data[i];
  }
}

static void set_up(void) {
  RCC_AHB1ENR |= 1u << 0;
  RCC_APB2ENR |= 1u << 4;
  GPIOA_MODER = (GPIOA_MODER & ~(0xFu << 18)) | 0xAu << 18;
  GPIOA_AFRH = (GPIOA_AFRH & ~(0xFFu << 4)) | 0x77u << 4;
  USART_BRR = (USART1_CLOCK_HZ + BAUD / 2) / BAUD;
  USART_CR1 = CR1_UE | CR1_TE | CR1_RE | CR1_RXNEIE;
  NVIC_ISER1 = 1u << (USART1_IRQ - 32);
  SYST_RVR = CORE_HZ / 1000 - 1;
  SYST_CVR = 0;
  SYST_CSR = 7; /* The core's clock, with its interrupt. */
}

/* --- The device ------------------------------------------------------------------------------- */

static struct octant_decoder decoder;
static struct octant_device device;
static uint16_t sequence;

static void say(const struct octant_message *messages, size_t count) {
  static uint8_t frame[OCTANT_MAX_FRAME];
  for (size_t i = 0; i < count; i++)
    send(frame, octant_encode(&messages[i], &sequence, now_ns(), frame));
}

static void received(void *with, const struct octant_message *message, uint16_t their_sequence,
                     uint64_t clock_ns) {
  (void)with;
  (void)their_sequence;
  (void)clock_ns;
  const struct octant_message *said;
  uint64_t now = now_ns();
  size_t count = octant_device_hear(&device, message, now, now_ns(), &said);
  say(said, count);
}

static void run(void) {
  uint32_t ticked = 0;
  for (;;) {
    const struct octant_message *said;
    while (ring_out != ring_in) {
      uint8_t byte = ring[ring_out % sizeof ring];
      ring_out++;
      octant_feed(&decoder, &byte, 1, received, NULL);
      if (decoder.newer) {
        struct octant_message bye = octant_device_refuses();
        decoder.newer = false;
        say(&bye, 1);
      }
    }
    if (milliseconds != ticked) {
      ticked = milliseconds;
      size_t count = octant_device_tick(&device, &decoder.counts, now_ns(), &said);
      say(said, count);
    }
    /* Asleep until the next byte or millisecond; one that comes between the look and the sleep wakes
     * it as well. */
    __asm volatile("cpsid i");
    if (ring_out == ring_in) __asm volatile("wfi");
    __asm volatile("cpsie i");
  }
}

/* --- Start ------------------------------------------------------------------------------------ */

/* Set by memory.ld. */
extern uint32_t stack_top, data_start, data_end, data_in_flash, bss_start, bss_end;

void Reset_Handler(void) {
  const uint32_t *from = &data_in_flash;
  for (uint32_t *to = &data_start; to < &data_end;) *to++ = *from++;
  for (uint32_t *to = &bss_start; to < &bss_end;) *to++ = 0;
  set_up();
  run();
}

/* A fault stands still: the harness finds that nobody answers. */
static void stop(void) {
  for (;;) {}
}

typedef void handler(void);

__attribute__((section(".vectors"), used)) static const struct {
  const void *stack;
  handler *system[15];
  handler *interrupts[82];
} VECTORS = {
  &stack_top,
  {Reset_Handler, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0, stop, SysTick_Handler},
  {[USART1_IRQ] = USART1_Handler},
};
