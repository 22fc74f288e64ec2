// Each line of the standard input as go-nmea understands it, as JSON; {"error": "..."} where it does not.
package main

import (
	"bufio"
	"encoding/json"
	"fmt"
	"os"

	nmea "github.com/adrianmo/go-nmea"
)

func main() {
	lines := bufio.NewScanner(os.Stdin)
	for lines.Scan() {
		sentence, err := nmea.Parse(lines.Text())
		var text []byte
		if err == nil {
			text, err = json.Marshal(sentence)
		}
		if err != nil {
			text, _ = json.Marshal(map[string]string{"error": err.Error()})
		}
		fmt.Println(string(text))
	}
}
