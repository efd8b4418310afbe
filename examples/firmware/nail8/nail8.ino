// nail8: a fingernail sensor of eight photodiodes and an LED, as lines of text or as frames.
//
// UNTESTED ON HARDWARE. The formats are those of README.md beside this file, whose example line and example frame are
// tested; this sketch is not.
//
// The LED is toggled before every sample: lit and unlit light are read in turn, and the ambient light is taken off later.
// A sample that could not be sent in time shows as a gap in the counter.

#define FRAMES 0                  // 0: lines of text, 1: frames of 27 bytes
const uint32_t PERIOD_US = 1000;  // 1 kHz: 500 pairs of lit and unlit a second
const uint32_t BAUD = 921600;     // lines need about 60 bytes a sample, frames 27; a byte takes 10 bits
const uint8_t LED_PIN = 2;
const uint32_t SETTLE_US = 100;   // from switching the LED to reading: the photodiodes' rise time, several times
const uint8_t PINS[8] = {A0, A1, A2, A3, A4, A5, A6, A7};

uint16_t counter = 0;
bool lit = false;
uint32_t due_us;

uint16_t crc16(const uint8_t *bytes, size_t count) {  // CRC-16/CCITT-FALSE
  uint16_t crc = 0xffff;
  while (count--) {
    crc ^= (uint16_t)*bytes++ << 8;
    for (uint8_t bit = 0; bit < 8; bit++) crc = crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1;
  }
  return crc;
}

void sendLine(const char *body) {  // $body*CRC, with the CRC of the body alone
  char end[8];
  snprintf(end, sizeof end, "*%04X\r\n", crc16((const uint8_t *)body, strlen(body)));
  Serial.write('$');
  Serial.write(body, strlen(body));
  Serial.write(end, strlen(end));
}

void sendNames() {
#if !FRAMES
  sendLine("time_us,n,led,P1,P2,P3,P4,P5,P6,P7,P8");
#endif
}

void sendFrame(uint32_t time_us, const uint16_t *p) {
  uint8_t frame[25];
  for (uint8_t k = 0; k < 8; k++) {
    frame[2 * k] = p[k] & 0xff;
    frame[2 * k + 1] = p[k] >> 8;
  }
  for (uint8_t k = 0; k < 4; k++) frame[16 + k] = time_us >> (8 * k) & 0xff;
  frame[20] = counter & 0xff;
  frame[21] = counter >> 8;
  frame[22] = lit ? 1 : 0;
  uint16_t crc = crc16(frame, 23);
  frame[23] = crc & 0xff;
  frame[24] = crc >> 8;
  uint8_t wire[27];  // COBS: each zero becomes the distance to the next one, and a zero ends the frame
  uint8_t mark = 0;
  for (uint8_t k = 0; k < 25; k++) {
    if (frame[k] == 0) {
      wire[mark] = k + 1 - mark;
      mark = k + 1;
    } else {
      wire[k + 1] = frame[k];
    }
  }
  wire[mark] = 26 - mark;
  wire[26] = 0;
  Serial.write(wire, sizeof wire);
}

void setup() {
  Serial.begin(BAUD);
  pinMode(LED_PIN, OUTPUT);
  delay(200);
  Serial.write("\r\n", 2);  // ends what the chip's own loader sent
  sendNames();
  due_us = micros() + PERIOD_US;
}

void loop() {
  if (Serial.available() && Serial.read() == '?') sendNames();  // for a reader that came late
  if ((int32_t)(micros() - due_us) < 0) return;
  due_us += PERIOD_US;
  lit = !lit;
  digitalWrite(LED_PIN, lit);
  delayMicroseconds(SETTLE_US);
  uint32_t time_us = micros();
  uint16_t p[8];
  for (uint8_t k = 0; k < 8; k++) p[k] = analogRead(PINS[k]);
  // Only what can be sent without waiting is sent: the counter shows the rest.
#if FRAMES
  if (Serial.availableForWrite() >= 27) sendFrame(time_us, p);
#else
  char body[80];
  snprintf(body, sizeof body, "%lu,%u,%u,%u,%u,%u,%u,%u,%u,%u,%u", (unsigned long)time_us, counter, lit ? 1 : 0, p[0],
           p[1], p[2], p[3], p[4], p[5], p[6], p[7]);
  if (Serial.availableForWrite() >= (int)strlen(body) + 8) sendLine(body);
#endif
  counter++;
}
