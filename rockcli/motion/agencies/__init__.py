"""The text formats in which agencies publish strong motion, as readers and as ObsPy waveform plug-ins."""
